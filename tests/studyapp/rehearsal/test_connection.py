from __future__ import annotations

import socket
import threading

from studyapp.rehearsal.visit import study_client

REQUESTS = 3


def test_a_connection_closed_between_requests_loses_no_request() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.settimeout(60)

        def serve() -> None:
            """Serve one request of each connection, and close it on the second one."""
            for _ in range(REQUESTS):
                connection, _address = listener.accept()
                with connection:
                    connection.recv(65536)
                    connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 3\r\n\r\nyes")
                    connection.recv(65536)

        threading.Thread(target=serve, daemon=True).start()
        with study_client(f"http://127.0.0.1:{listener.getsockname()[1]}") as client:
            assert [client.get("/").status_code for _ in range(REQUESTS)] == [200] * REQUESTS
