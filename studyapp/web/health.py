"""Whether the server is well: for whatever starts, watches or replaces it."""

from __future__ import annotations

from typing import Final

from flask import Blueprint, Response
from sqlalchemy import select
from sqlalchemy.exc import SQLAlchemyError

from studyapp.models import StudyVersion
from studyapp.web.running import running

HEALTH: Final = "/healthz"

pages = Blueprint("health", __name__)


@pages.get(HEALTH)
def health() -> Response:
    """Say whether the database answers; nothing of the study is told."""
    try:
        with running().database.looking_up() as connection:
            connection.execute(select(StudyVersion.id).limit(1)).first()
    except SQLAlchemyError:
        return Response("The database is away.\n", 503, mimetype="text/plain")
    return Response("ok\n", mimetype="text/plain")
