"""The study once more below ``/try/``, for who tries it."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Final

from flask import Flask, request

if TYPE_CHECKING:
    from _typeshed.wsgi import StartResponse, WSGIApplication, WSGIEnvironment

PREFIX: Final = "/try"


class WithTestParticipations:
    """The study for participants, and below `PREFIX` the same for who tries it.

    Parameters
    ----------
    study : WSGI application
        For participants.
    make_tried : callable
        Makes the other one, once somebody asks for it.
    tries : Path
        Its database. Without it nobody has a link, and nothing is made.
    """

    def __init__(
        self, study: WSGIApplication, make_tried: Callable[[], Flask], tries: Path
    ) -> None:
        self._study = study
        self._make_tried = make_tried
        self._tries = tries
        self._tried: Flask | None = None
        self._making = threading.Lock()

    def __call__(self, environ: WSGIEnvironment, start_response: StartResponse) -> Iterable[bytes]:
        """Answer a request."""
        path = environ.get("PATH_INFO", "")
        if not path.startswith(f"{PREFIX}/") or not self._tries.exists():
            return self._study(environ, start_response)
        with self._making:
            self._tried = self._tried or self._make_tried()
        here = {
            "SCRIPT_NAME": environ.get("SCRIPT_NAME", "") + PREFIX,
            "PATH_INFO": path.removeprefix(PREFIX),
        }
        return self._tried({**environ, **here}, start_response)


def address_to_try(token: str) -> str:
    """Return where the holder of `token` tries the study, from the host's root."""
    return f"{request.script_root}{path_to_try(token)}"


def path_to_try(token: str) -> str:
    """Return the same from the study's root."""
    return f"{PREFIX}/?invitation={token}"
