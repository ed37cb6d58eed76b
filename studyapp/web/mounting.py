"""The study below a path of its host, and once more below ``/try/`` for who tries it.

Every address begins with that path. A proxy in front passes addresses on as they are. Nobody can
name another path in a header.
"""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from flask import Flask, request
from werkzeug.utils import redirect
from werkzeug.wrappers import Request, Response

from motion.errors import InputError
from studyapp.web.protection import PROTECTION

if TYPE_CHECKING:
    from _typeshed.wsgi import StartResponse, WSGIApplication, WSGIEnvironment

PREFIX: Final = re.compile(r"(/[A-Za-z0-9_~-][A-Za-z0-9._~-]*)+")
"""Parts that need no escaping in any file or address; none is ``.`` or ``..``."""


HEALTH: Final = "/healthz"
TRY: Final = "/try"


def below(prefix: str, environ: WSGIEnvironment) -> WSGIEnvironment | None:
    """Return a request as the application mounted at `prefix` gets it; None if it is not below."""
    path = environ.get("PATH_INFO", "")
    if not path.startswith(f"{prefix}/"):
        return None
    root = environ.get("SCRIPT_NAME", "") + prefix
    return {**environ, "SCRIPT_NAME": root, "PATH_INFO": path.removeprefix(prefix)}


def at_sub_path(application: WSGIApplication, prefix: str) -> WSGIApplication:
    """Return `application` reached below a path.

    Parameters
    ----------
    prefix : str
        Such as ``/studies/one``; see `checked_prefix`.
    """

    def answer(environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        path = environ.get("PATH_INFO", "")
        inside = below(prefix, {**environ, "SCRIPT_NAME": ""})
        # Who looks whether the server is well asks it directly, past any proxy.
        if inside is not None or path == HEALTH:
            return application(inside or environ, start_response)
        if path == prefix:
            asked = Request(environ).query_string.decode("latin-1")
            elsewhere = redirect(f"{prefix}/{asked and f'?{asked}'}", 308)
        else:
            elsewhere = Response("There is no such page.\n", 404, mimetype="text/plain")
        elsewhere.headers.update(PROTECTION | {"Cache-Control": "no-store"})
        # An address without a host stays on the host, and scheme, by which the proxy was asked.
        elsewhere.autocorrect_location_header = False
        return elsewhere(environ, start_response)

    return answer


def with_test_participations(
    study: WSGIApplication, make_tried: Callable[[], Flask], tries: Path
) -> WSGIApplication:
    """Return the study for participants, and below `TRY` the same for who tries it.

    Parameters
    ----------
    study : WSGI application
        For participants.
    make_tried : callable
        Makes the other one, once somebody asks for it.
    tries : Path
        Its database. Without it nobody has a link, and nothing is made.
    """
    made_once, making = cache(make_tried), threading.Lock()

    def answer(environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        inside = below(TRY, environ)
        if inside is None or not tries.exists():
            return study(environ, start_response)
        with making:
            tried = made_once()
        return tried(inside, start_response)

    return answer


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


if TYPE_CHECKING:
    from _typeshed.wsgi import StartResponse, WSGIApplication, WSGIEnvironment


def address_to_try(token: str) -> str:
    """Return where the holder of `token` tries the study, from the host's root."""
    return f"{request.script_root}{path_to_try(token)}"


def path_to_try(token: str) -> str:
    """Return the same from the study's root."""
    return f"{TRY}/?invitation={token}"
