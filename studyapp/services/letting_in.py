"""Whether anybody new is let in, and what newcomers are told where nobody is."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import Connection
from sqlalchemy.orm import Session

from studyapp.services.intake import Intake
from studyapp.services.places import has_open_place
from studyapp.services.refusal import StudyFullError
from studyapp.services.served_study import ServedStudy


def require_room(
    reading: Session | Connection, served: ServedStudy, intake: Intake, now: datetime
) -> None:
    """Raise `StudyFullError` unless newcomers are let in and there is a place for one."""
    require_let_in(served, intake)
    if not has_open_place(reading, served, intake, now):
        raise study_is_full()


def require_let_in(served: ServedStudy, intake: Intake) -> None:
    """Raise `StudyFullError` unless newcomers are let in, whether or not there is a place."""
    state = intake.state
    if state == "closed":
        raise StudyFullError(
            "The study is over: it takes no more participants.",
            "Thank you for your interest.",
        )
    if state == "paused":
        raise StudyFullError(
            "The study is paused at the moment.",
            "Thank you for your interest. Please come back later: the same link works then.",
        )
    if not served.study.open:
        raise StudyFullError(
            "The study takes no new participants at the moment.",
            "Thank you for your interest. You can try later with the same link.",
        )


def study_is_full() -> StudyFullError:
    """Return what newcomers are told while every place is held."""
    return StudyFullError(
        "The study has all the participants it needs at the moment.",
        "Thank you for your interest. A place may open again: you can try later with the "
        "same link.",
    )
