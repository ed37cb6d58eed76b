from __future__ import annotations

import socket
import threading
from collections.abc import Iterator

import pytest

from studyapp.rehearsal.visit import study_client

REQUESTS = 3


@pytest.fixture
def impatient_server() -> Iterator[str]:
    """Serve one request of each connection, and close it without a word on the second one."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.settimeout(60)

        def serve() -> None:
            for _ in range(REQUESTS):
                connection, _address = listener.accept()
                with connection:
                    connection.recv(65536)
                    connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 3\r\n\r\nyes")
                    connection.recv(65536)

        threading.Thread(target=serve, daemon=True).start()
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"


def test_a_connection_that_the_server_closes_between_requests_loses_none(
    impatient_server: str,
) -> None:
    with study_client(impatient_server) as client:
        assert [client.get("/").status_code for _ in range(REQUESTS)] == [200] * REQUESTS
