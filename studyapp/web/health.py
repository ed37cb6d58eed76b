"""Whether the server is well: for whatever starts, watches or replaces it."""

from __future__ import annotations

import logging
import threading
import time
from typing import Final, cast

from flask import Blueprint, Response, current_app
from sqlalchemy.exc import SQLAlchemyError

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.web.running import running

HEALTH: Final = "/healthz"

KNOWN_SECONDS: Final = 1.0
"""For how long the last answer stands: anybody may ask, and to find out costs a write."""

ANSWER_SECONDS: Final = 5.0
"""How long the database may take. One that is frozen, or has no connection left, takes longer."""

pages = Blueprint("health", __name__)


@pages.get(HEALTH)
def health() -> Response:
    """Say whether answers can be stored; nothing of the study is told."""
    known = cast(Health, current_app.extensions.setdefault(HEALTH, Health()))
    if not known.is_well(running().database, current_app.logger):
        return Response("Answers cannot be stored.\n", 503, mimetype="text/plain")
    return Response("ok\n", mimetype="text/plain")


class Health:
    """Whether answers can be stored, as one attempt after the other finds out."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._attempt: _Attempt | None = None

    def is_well(self, database: Database, log: logging.Logger) -> bool:
        """Return what the last attempt found, or a new one; False where it has no end in time."""
        with self._lock:
            if self._attempt is None or self._attempt.is_outdated:
                self._attempt = _Attempt(database, log)
            attempt = self._attempt
        return attempt.succeeds()


class _Attempt:
    """An attempt to write, beside the requests that wait for it."""

    def __init__(self, database: Database, log: logging.Logger) -> None:
        self._began = time.monotonic()
        self._ended = threading.Event()
        self._succeeded = False
        threading.Thread(target=self._write, args=(database, log), daemon=True).start()

    @property
    def is_outdated(self) -> bool:
        """Whether it has ended, and what it found stands no longer."""
        return self._ended.is_set() and time.monotonic() - self._began >= KNOWN_SECONDS

    def succeeds(self) -> bool:
        """Tell whether it has succeeded, as soon as it has, or has had its time."""
        self._ended.wait(max(0.0, self._began + ANSWER_SECONDS - time.monotonic()))
        return self._succeeded

    def _write(self, database: Database, log: logging.Logger) -> None:
        try:
            database.try_writing()
            self._succeeded = True
        except (SQLAlchemyError, InputError, OSError) as error:
            cause = getattr(error, "orig", None) or error
            log.error("Not well: %s", (str(cause).splitlines() or [""])[0])
        finally:
            self._ended.set()
