"""The log of looks at results: who saw them, when, why, and how far the study was.

Who stops, extends or changes something at a good moment takes chance for an effect. So every look
is kept, and reports say which there were before the answers that they rest on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Final, Literal

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import Event, Look, ResearcherLogin, Response, StudySession, Trial
from studyapp.researchers.audit import log_change, reason_given
from studyapp.researchers.tokens import token_hash

Way = Literal["page", "report", "export"]

EVENTS: Final[dict[Way, Event]] = {
    "page": Event.LOOKED_AT,
    "report": Event.REPORTED,
    "export": Event.EXPORTED,
}
COMMAND_LINE: Final = "command line"
SHOWN: Final = 200
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


def note_look(
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
    log_change(session, now, EVENTS[way], by=by, detail=detail, reason=reason)


def looks(database: Database) -> Sequence[Look]:
    """Return the newest `SHOWN` looks, the newest first."""
    query = select(Look).order_by(Look.id.desc()).limit(SHOWN)
    with database.reading() as session:
        return session.scalars(query).all()


def answers_so_far(session: Session) -> int:
    """Return how many answers there are of those who have not withdrawn."""
    query = (
        select(func.count(Response.id))
        .join(Trial, Trial.id == Response.trial_id)
        .join(StudySession, StudySession.id == Trial.study_session_id)
        .where(StudySession.withdrawn_at.is_(None))
    )
    return session.scalar(query) or 0


HOLDS: Final = timedelta(hours=1)
"""So long, looking again in the same login needs no new reason; each look is logged anyway."""


def unblind(database: Database, clock: Clock, token: str, *, by: str, reason: str) -> None:
    """Let the login of `token` see results for a while.

    Parameters
    ----------
    by : str
        The researcher's name, for the log.

    Raises
    ------
    InputError
        If no reason is given.
    """
    reason = reason_given(reason)
    with database.writing() as session:
        now = clock.now()
        session.execute(
            update(ResearcherLogin)
            .where(ResearcherLogin.token_hash == token_hash(token))
            .values(unblinded_at=now, unblinding_reason=reason)
        )
        log_change(session, now, Event.UNBLINDED, by=by, reason=reason)


def unblinded_because(database: Database, token: str, now: datetime) -> str:
    """Return for which reason the login of `token` sees results; empty where it does not."""
    query = select(ResearcherLogin.unblinding_reason).where(
        ResearcherLogin.token_hash == token_hash(token),
        ResearcherLogin.unblinded_at > now - HOLDS,
    )
    with database.reading() as session:
        return session.scalars(query).first() or ""
