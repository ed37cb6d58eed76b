"""Servers of this machine that answer from a thread while a test runs."""

import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from http.server import HTTPServer
from wsgiref.types import StartResponse, WSGIApplication, WSGIEnvironment

from werkzeug.serving import make_server
from werkzeug.wsgi import ClosingIterator

NOTICED_WITHIN = 0.02
"""Seconds within which a server notices that it is to end."""


@contextmanager
def answering(server: HTTPServer) -> Iterator[str]:
    """Let `server` answer, and give its address."""
    thread = threading.Thread(target=server.serve_forever, args=[NOTICED_WITHIN])
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@contextmanager
def listening(app: WSGIApplication) -> Iterator[str]:
    """Let `app` answer, and give its address."""
    with answering(make_server("127.0.0.1", 0, _whole(app), threaded=True)) as address:
        yield address


def _whole(app: WSGIApplication) -> WSGIApplication:
    """Close an answer's file before it is sent.

    Werkzeug's server leaves it open where a browser hangs up early; gunicorn closes it.
    """

    def answered(environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        parts = ClosingIterator(app(environ, start_response))
        try:
            return [b"".join(parts)]
        finally:
            parts.close()

    return answered
