"""The study below a path of its host, and again below ``/try/`` for test participations.

Every address begins with that path. A proxy in front passes addresses on unchanged, and no header
can name another path.
"""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from flask import Flask
from werkzeug.wrappers import Response

from motion.errors import InputError
from studyapp.web.protection import PROTECTION

if TYPE_CHECKING:
    from _typeshed.wsgi import StartResponse, WSGIApplication, WSGIEnvironment

PREFIX: Final = re.compile(r"(/[A-Za-z0-9_~-][A-Za-z0-9._~-]*)+")
"""Parts that need no escaping in files and addresses; none is ``.`` or ``..``."""

HEALTH: Final = "/healthz"
TRY: Final = "/try"


def below(prefix: str, environ: WSGIEnvironment) -> WSGIEnvironment | None:
    """Return a request as the application mounted at `prefix` gets it; None if it is not below."""
    path = environ.get("PATH_INFO", "")
    if not f"{path}/".startswith(f"{prefix}/"):
        return None
    root = environ.get("SCRIPT_NAME", "") + prefix
    return {**environ, "SCRIPT_NAME": root, "PATH_INFO": path.removeprefix(prefix) or "/"}


def at_sub_path(application: WSGIApplication, prefix: str) -> WSGIApplication:
    """Return `application` reached below a path.

    Parameters
    ----------
    prefix : str
        Such as ``/studies/one``; see `checked_prefix`.
    """

    def dispatch(environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        inside = below(prefix, {**environ, "SCRIPT_NAME": ""})
        # Health checks come directly, past any proxy.
        if inside is not None or environ.get("PATH_INFO") == HEALTH:
            return application(inside or environ, start_response)
        response = Response("There is no such page.\n", 404, mimetype="text/plain")
        response.headers.update(PROTECTION | {"Cache-Control": "no-store"})
        return response(environ, start_response)

    return dispatch


def with_test_participations(
    study: WSGIApplication, make_test: Callable[[], Flask], database: Path
) -> WSGIApplication:
    """Return the study for participants, and below `TRY` the same for test participations.

    Parameters
    ----------
    study : WSGI application
        For participants.
    make_test : callable
        Makes the other one, when somebody first asks for it.
    database : Path
        The other database. Without it nobody has a link, and nothing is made.
    """
    make_once, lock = cache(make_test), threading.Lock()

    def dispatch(environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        inside = below(TRY, environ)
        if inside is None or not database.exists():
            return study(environ, start_response)
        with lock:
            test = make_once()
        return test(inside, start_response)

    return dispatch


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


def path_to_try(token: str) -> str:
    """Return the path from the study's root of the test participation with `token`."""
    return f"{TRY}/?invitation={token}"
