"""A small proxy: passes on what lies below a path, and nothing else."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, contextmanager
from http.client import HTTPConnection
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import urlsplit

from tests.support.servers.local_server import answering

OF_ONE_CONNECTION = {"connection", "keep-alive", "transfer-encoding"}


@contextmanager
def passing_on(server: str, prefix: str) -> Iterator[tuple[str, list[str]]]:
    """Pass on to `server` what begins with `prefix`.

    Yields
    ------
    tuple of str and list of str
        The proxy's address, and what was asked of it beside that path.
    """
    beside: list[str] = []
    host = urlsplit(server).netloc

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def pass_on(self) -> None:
            body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
            if self.path != prefix and not self.path.startswith((f"{prefix}/", f"{prefix}?")):
                beside.append(self.path)
                self.send_error(404)
                return
            headers = {
                name: value
                for name, value in self.headers.items()
                if name.lower() not in OF_ONE_CONNECTION
            }
            headers["X-Forwarded-For"] = self.client_address[0]
            with closing(HTTPConnection(host, timeout=60)) as connection:
                connection.request(self.command, self.path, body, headers)
                answer = connection.getresponse()
                content = answer.read()
            self.send_response(answer.status)
            for name, value in answer.getheaders():
                if name.lower() not in {"content-length", "date", "server"} | OF_ONE_CONNECTION:
                    self.send_header(name, value)
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        do_GET = do_POST = pass_on  # noqa: N815 - so the library calls them

        def log_message(self, format: str, *args: object) -> None:
            """Say nothing."""

    proxy = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    with answering(proxy) as address:
        yield address, beside
