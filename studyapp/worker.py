"""gunicorn's worker, with a log that holds nothing of what was asked for."""

from __future__ import annotations

import socket
import traceback
from contextlib import suppress
from typing import Any, Final

from gunicorn import util  # type: ignore[import-untyped]
from gunicorn.http import errors  # type: ignore[import-untyped]
from gunicorn.workers.gthread import ThreadWorker  # type: ignore[import-untyped]

BAD_REQUEST: Final = (400, "Bad Request")
REFUSALS: Final[dict[type[Exception], tuple[int, str]]] = {
    errors.LimitRequestLine: (414, "URI Too Long"),
    errors.LimitRequestHeaders: (431, "Request Header Fields Too Large"),
    errors.ExpectationFailed: (417, "Expectation Failed"),
    errors.UnsupportedTransferCoding: (501, "Not Implemented"),
    errors.ForbiddenProxyRequest: (403, "Forbidden"),
}
"""What is no request of HTTP as it should be, and is not answered with `BAD_REQUEST`."""

OWN_FAULTS: Final = (
    errors.InvalidResponseHeader,
    errors.InvalidResponseHeaderName,
    errors.ConfigurationProblem,
)


class StudyWorker(ThreadWorker):  # type: ignore[misc]
    """A process that handles requests in threads.

    gunicorn's own words about a request that cannot be read, or that fails, quote it: its
    address holds a participant's token.
    """

    def handle_error(self, req: Any, client: socket.socket, addr: Any, exc: Exception) -> None:
        """Answer a request that is no HTTP, or that failed outside all pages."""
        del req, addr
        if isinstance(exc, errors.ParseException) and not isinstance(exc, OWN_FAULTS):
            status, reason = REFUSALS.get(type(exc), BAD_REQUEST)
        else:
            status, reason = 500, "Internal Server Error"
            where = "".join(traceback.format_tb(exc.__traceback__))
            self.log.error("Failed outside all pages: %s\n%s", type(exc).__name__, where)
        with suppress(OSError):
            util.write_error(client, status, reason, "")
