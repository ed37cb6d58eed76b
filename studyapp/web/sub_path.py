"""A study below a path of its host: every address of it begins with that path.

A proxy in front passes addresses on as they are. Nobody can name another path in a header.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from werkzeug.utils import redirect
from werkzeug.wrappers import Request, Response

from motion.errors import InputError
from studyapp.web.headers import PROTECTION
from studyapp.web.health import HEALTH

if TYPE_CHECKING:
    from _typeshed.wsgi import StartResponse, WSGIApplication, WSGIEnvironment

PREFIX: Final = re.compile(r"(/[A-Za-z0-9_~-][A-Za-z0-9._~-]*)+")
"""Parts that need no escaping in any file or address; none is ``.`` or ``..``."""


class SubPath:
    """The application, reached below a path.

    Parameters
    ----------
    application : WSGI application
        What is reached there.
    prefix : str
        Such as ``/studies/one``; see `checked_prefix`.
    """

    def __init__(self, application: WSGIApplication, prefix: str) -> None:
        self.application = application
        self.prefix = prefix

    def __call__(self, environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        """Answer a request, or say where the study is."""
        path = environ.get("PATH_INFO", "")
        if path.startswith(f"{self.prefix}/"):
            here = {"SCRIPT_NAME": self.prefix, "PATH_INFO": path.removeprefix(self.prefix)}
            return self.application({**environ, **here}, start_response)
        if path == HEALTH:
            # Who looks whether the server is well asks it directly, past any proxy.
            return self.application(environ, start_response)
        if path == self.prefix:
            asked = Request(environ).query_string.decode("latin-1")
            answer = redirect(f"{self.prefix}/{asked and f'?{asked}'}", 308)
        else:
            answer = Response("There is no such page.\n", 404, mimetype="text/plain")
        answer.headers.update(PROTECTION | {"Cache-Control": "no-store"})
        # An address without a host stays on the host, and scheme, by which the proxy was asked.
        answer.autocorrect_location_header = False
        return answer(environ, start_response)


def checked_prefix(text: str) -> str:
    """Return the path `text` without a slash at its end; empty for the whole host.

    Raises
    ------
    InputError
        If it is not a path that can stand in an address as it is.
    """
    path = text.rstrip("/")
    if path and PREFIX.fullmatch(path) is None:
        raise InputError(
            "this is not a path that a study can be served below",
            where=f"prefix {text!r}",
            remedy="Begin it with / and use letters, digits, '-' and '_', such as /studies/one",
        )
    return path
