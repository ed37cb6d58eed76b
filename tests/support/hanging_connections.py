"""Connections that a server is left hanging on: endless requests and unread responses."""

import socket
import ssl
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress

ATTACKER = "127.0.0.2"
"""Also an address of this machine, but not that of the honest participant."""

EVERY_SECONDS = 0.5


@contextmanager
def hanging(
    port: int,
    request: bytes,
    count: int,
    *,
    trickle: bytes = b"",
    tls: ssl.SSLContext | None = None,
    host: str = "",
) -> Iterator[None]:
    """Send `request` on `count` connections and read nothing; then keep sending `trickle`."""
    with ExitStack() as opened:
        connections = []
        for _ in range(count):
            connection = socket.socket()
            opened.callback(connection.close)
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            connection.bind((ATTACKER, 0))
            connection.settimeout(10)
            # A server may refuse some of so many.
            with suppress(OSError):
                connection.connect(("127.0.0.1", port))
                if tls is not None:
                    connection = tls.wrap_socket(connection, server_hostname=host)
                    opened.callback(connection.close)
                connection.sendall(request)
                connections.append(connection)
        assert len(connections) > count // 4
        over = threading.Event()
        feeder = threading.Thread(target=_feed, args=(connections, trickle, over))
        feeder.start()
        try:
            yield
        finally:
            over.set()
            feeder.join()


def slow_body(path: str, host: str) -> bytes:
    """Return a request that is shorter than its announced length."""
    head = f"POST {path} HTTP/1.1\r\nHost: {host}\r\nContent-Length: 60000\r\n"
    return f"{head}Content-Type: application/x-www-form-urlencoded\r\n\r\nvisit=".encode()


def whole_video(path: str, host: str) -> bytes:
    """Return a request for a video."""
    return f"GET {path} HTTP/1.1\r\nHost: {host}\r\nRange: bytes=0-\r\n\r\n".encode()


def _feed(connections: list[socket.socket], trickle: bytes, over: threading.Event) -> None:
    while not over.wait(EVERY_SECONDS):
        for connection in connections:
            with suppress(OSError):
                connection.sendall(trickle)
