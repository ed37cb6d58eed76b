"""Whether the server is well: for whatever starts, watches or replaces it."""

from __future__ import annotations

import math
import time
from typing import Final

from flask import Blueprint, Response, current_app
from sqlalchemy.exc import SQLAlchemyError

from motion.errors import InputError
from studyapp.services.database import Database
from studyapp.web.running import running

HEALTH: Final = "/healthz"

KNOWN_SECONDS: Final = 1.0
"""For how long the last answer stands: anybody may ask, and to find out costs a write."""

pages = Blueprint("health", __name__)


@pages.get(HEALTH)
def health() -> Response:
    """Say whether answers can be stored; nothing of the study is told."""
    known: tuple[float, bool] = current_app.extensions.get(HEALTH, (-math.inf, False))
    if time.monotonic() - known[0] >= KNOWN_SECONDS:
        known = (time.monotonic(), _is_well(running().database))
        current_app.extensions[HEALTH] = known
    if not known[1]:
        return Response("Answers cannot be stored.\n", 503, mimetype="text/plain")
    return Response("ok\n", mimetype="text/plain")


def _is_well(database: Database) -> bool:
    try:
        database.try_writing()
    except (SQLAlchemyError, InputError, OSError) as error:
        cause = getattr(error, "orig", None) or error
        current_app.logger.error("Not well: %s", (str(cause).splitlines() or [""])[0])
        return False
    return True
