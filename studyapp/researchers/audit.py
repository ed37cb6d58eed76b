"""The log of changes and of looks at results: who did what, when and why.

Lines are only ever added. Who stops, extends or changes something at a good moment takes chance for
an effect. So every look is kept with how far the study was, and reports say which there were before
the answers that they rest on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from types import MappingProxyType
from typing import Final, Literal

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.database.tables import (
    AuditLine,
    Event,
    Look,
    Response,
    StudySession,
    Trial,
)

MAX_LINES: Final = 200
"""As many are shown at once."""

MAX_REASON_LENGTH: Final = 500

ERASED: Final = "(erased)"
"""What stands in place of what would name or describe somebody who is to be forgotten."""

EVENT_LABELS: Final[Mapping[Event, str]] = MappingProxyType(
    {
        Event.RESTORED: "restored from a backup",
        Event.NEWCOMERS_LET_IN: "opened to new participants",
        Event.NEWCOMERS_PAUSED: "recruitment paused",
        Event.NEWCOMERS_CLOSED: "closed to new participants",
        Event.PASSWORD_OFFERED: "new password offered",
        Event.SHUT_OUT: "access removed",
        Event.LET_IN_AGAIN: "access restored",
        Event.SECOND_FACTOR_ON: "second factor turned on",
        Event.SECOND_FACTOR_OFF: "second factor turned off",
        Event.DEFINITION_EDITED: "study file edited",
        Event.JOB_BEGUN: "job started",
        Event.MATERIAL_REMOVED: "file removed",
    }
)
"""How events are told to people whose own names say it less well."""


@dataclass(frozen=True, kw_only=True)
class LoggedChange:
    """One line of the log in words; see `studyapp.database.tables.AuditLine`."""

    id: int
    at: datetime
    researcher: str
    event: str
    detail: str
    reason: str


def read_reason(text: str) -> str:
    """Return a reason in a researcher's words, on one line.

    Raises
    ------
    InputError
        If there is none, it is too long, or it cannot be stored.
    """
    reason = " ".join(text.split())
    storable = "\0" not in reason and reason == reason.encode("utf-8", "ignore").decode("utf-8")
    if not 1 <= len(reason) <= MAX_REASON_LENGTH or not storable:
        raise InputError(
            f"a reason of 1 to {MAX_REASON_LENGTH} letters is needed",
            remedy="It stands in the log, for whoever asks later",
        )
    return reason


def log_change(
    session: Session,
    now: datetime,
    event: Event,
    *,
    by: str,
    study_session: int | None = None,
    detail: str = "",
    reason: str = "",
) -> None:
    """Add a line to the log, stored with what it tells of or not at all.

    Parameters
    ----------
    by : str
        The researcher's name; empty for the command line.
    study_session : int, optional
        The study session that it is about.
    """
    session.add(
        AuditLine(
            at=now,
            event=event,
            study_session=study_session,
            detail=detail,
            researcher=by,
            reason=reason,
        )
    )


def event_label(line: AuditLine) -> str:
    """Return what was done, in words."""
    event = Event(line.event)
    return EVENT_LABELS.get(event, event.replace("_", " "))


def detail_label(line: AuditLine) -> str:
    """Return what there is to know of a change, in words: whom it is about, and how."""
    whom = "" if line.study_session is None else f"study session {line.study_session}"
    return ", ".join(filter(None, (whom, line.detail)))


def latest_changes(database: Database, *, before: int | None = None) -> list[LoggedChange]:
    """Return the newest `MAX_LINES` lines of the log older than `before`, the newest first.

    Parameters
    ----------
    before : int, optional
        The `id` of a line.
    """
    query = select(AuditLine).order_by(AuditLine.id.desc()).limit(MAX_LINES)
    if before is not None:
        query = query.where(AuditLine.id < before)
    with database.reading() as session:
        return [
            LoggedChange(
                id=line.id,
                at=line.at,
                researcher=line.researcher,
                event=event_label(line),
                detail=detail_label(line),
                reason=line.reason,
            )
            for line in session.scalars(query)
        ]


Way = Literal["page", "report", "export"]

LOOK_EVENTS: Final[dict[Way, Event]] = {
    "page": Event.LOOKED_AT,
    "report": Event.REPORTED,
    "export": Event.EXPORTED,
}
COMMAND_LINE: Final = "command line"
MAX_LOOKS: Final = 200
"""As many are listed on the page."""


@dataclass(frozen=True, kw_only=True)
class StudyState:
    """How far the study is.

    Attributes
    ----------
    finished, planned : int
        Participants who have finished and hold a place, and places in all.
    answers : int
        Answers of everybody who has not withdrawn.
    """

    finished: int
    planned: int
    answers: int

    @property
    def is_interim(self) -> bool:
        """Whether there are participants still to come."""
        return self.finished < self.planned


def log_look(
    session: Session, now: datetime, state: StudyState, *, way: Way, by: str = "", reason: str = ""
) -> None:
    """Log a look at results; to be stored before they are shown.

    Parameters
    ----------
    state : StudyState
        What the results rest on.
    by : str
        The researcher's name; empty for the command line.
    """
    session.add(
        Look(
            at=now,
            way=way,
            researcher=by,
            reason=reason,
            finished=state.finished,
            planned=state.planned,
            answers=state.answers,
        )
    )
    detail = f"{state.finished} of {state.planned} participants had finished"
    log_change(session, now, LOOK_EVENTS[way], by=by, detail=detail, reason=reason)


def latest_looks(database: Database) -> Sequence[Look]:
    """Return the newest `MAX_LOOKS` looks, the newest first."""
    query = select(Look).order_by(Look.id.desc()).limit(MAX_LOOKS)
    with database.reading() as session:
        return session.scalars(query).all()


def count_answers(session: Session) -> int:
    """Return how many answers there are of those who have not withdrawn."""
    query = (
        select(func.count(Response.id))
        .join(Trial, Trial.id == Response.trial_id)
        .join(StudySession, StudySession.id == Trial.study_session_id)
        .where(StudySession.withdrawn_at.is_(None))
    )
    return session.scalar(query) or 0
