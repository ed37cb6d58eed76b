"""A participant's way to the first video, gone on a database that is thrown away."""

from __future__ import annotations

import secrets
from dataclasses import replace

from sqlalchemy import select

from studyapp.clock import Clock
from studyapp.definition.form import Form
from studyapp.models import Video
from studyapp.services.database import Database
from studyapp.services.enrolment import Arrival, enrol
from studyapp.services.served_study import ServedStudy
from studyapp.services.taking_part import begin


def for_probing(served: ServedStudy) -> ServedStudy:
    """Return the study with nothing before its first trial, open to whoever comes."""
    study = served.study
    page = study.page.model_copy(update={"sound_check": False})
    return replace(
        served, study=study.model_copy(update={"open": True, "form": Form(), "page": page})
    )


def token_of_a_video(database: Database, served: ServedStudy, clock: Clock) -> str:
    """Let somebody begin, and name the first video that they are shown.

    Parameters
    ----------
    served : ServedStudy
        From `for_probing`.
    """
    token = enrol(database, served, Arrival(visit=secrets.token_urlsafe()), clock)
    begin(database, served, token, clock)
    with database.reading() as session:
        return session.scalars(select(Video.token).order_by(Video.id).limit(1)).one()
