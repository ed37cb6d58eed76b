"""The log of changes, and of looks at results: who did what, when and why.

Lines are only ever added. Stopping, extending or changing a study after a look at results inflates
effects. So every look is stored with the state of the study, and reports list them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Final, Literal

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.database.tables.researchers import AuditLine, Event, Look
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Response, Trial

MAX_LINES: Final = 200
"""Lines shown at once."""

MAX_REASON_LENGTH: Final = 500

ERASED: Final = "(erased)"
"""Replaces text about somebody who is forgotten."""

EVENT_LABELS: Final[Mapping[Event, str]] = {
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
    Event.MATERIAL_REMOVED: "material removed",
}
"""Labels of events whose names are not clear enough."""


def read_reason(text: str) -> str:
    """Return a researcher's reason on one line.

    Raises
    ------
    InputError
        If it is empty, too long, or cannot be stored.
    """
    reason = " ".join(text.split())
    is_storable = "\0" not in reason and reason == reason.encode("utf-8", "ignore").decode("utf-8")
    if not 1 <= len(reason) <= MAX_REASON_LENGTH or not is_storable:
        raise InputError(
            f"a reason of 1 to {MAX_REASON_LENGTH} characters is needed",
            remedy="It is kept in the log",
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
    """Add a line to the log, in the same transaction as the change.

    Parameters
    ----------
    by : str
        The researcher's name; empty for the command line.
    study_session : int, optional
        The study session that the change is about.
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
    return EVENT_LABELS.get(Event(line.event), line.event.replace("_", " "))


def detail_label(line: AuditLine) -> str:
    """Return the study session and the details of a change, in words."""
    subject = "" if line.study_session is None else f"study session {line.study_session}"
    return ", ".join(filter(None, (subject, line.detail)))


def latest_changes(database: Database, *, before: int | None = None) -> Sequence[AuditLine]:
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
        return session.scalars(query).all()


Way = Literal["page", "report", "export"]

LOOK_EVENTS: Final[dict[Way, Event]] = {
    "page": Event.LOOKED_AT,
    "report": Event.REPORTED,
    "export": Event.EXPORTED,
}
COMMAND_LINE: Final = "command line"
MAX_LOOKS: Final = 200
"""Looks listed on the page."""


@dataclass(frozen=True, kw_only=True)
class StudyState:
    """The progress of the study.

    Attributes
    ----------
    finished, planned : int
        Finished participants with a place, and all places.
    answers : int
        Answers of participants who have not withdrawn.
    """

    finished: int
    planned: int
    answers: int

    @property
    def is_interim(self) -> bool:
        """Whether participants are still missing."""
        return self.finished < self.planned


def log_look(
    session: Session, now: datetime, state: StudyState, *, way: Way, by: str = "", reason: str = ""
) -> None:
    """Log a look at results; to be stored before they are shown.

    Parameters
    ----------
    state : StudyState
        The progress of the study at the time of the results.
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
    """Count the answers of participants who have not withdrawn."""
    query = (
        select(func.count(Response.id))
        .join(Trial, Trial.id == Response.trial_id)
        .join(StudySession, StudySession.id == Trial.study_session_id)
        .where(StudySession.withdrawn_at.is_(None))
    )
    return session.scalar(query) or 0
