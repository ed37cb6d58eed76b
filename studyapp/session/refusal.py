"""Refused requests of participants, and their messages."""

import logging
from collections.abc import Mapping
from typing import Final

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.exc import SQLAlchemyError

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.study_session import RefusalLine, StudySession
from studyapp.study.settings.presentation import Message, Value
from studyapp.study.settings.questions import Stage


class RefusalError(Exception):
    """A request that changes nothing; what was stored before stays stored.

    Parameters
    ----------
    what : str
        A sentence for the participant about what happened: a literal with named placeholders, so
        that it can be translated.
    remedy : str
        A sentence about what they can do.
    **values : int, str, Message or tuple of them
        Values of the placeholders in both.
    """

    def __init__(self, what: str, remedy: str, /, **values: Value) -> None:
        self.messages = (Message(what, **values), Message(remedy, **values))
        super().__init__(" ".join(map(str, self.messages)))

    @property
    def what(self) -> str:
        """What happened, in English."""
        return str(self.messages[0])


class UnknownAddressError(RefusalError):
    """There is no such study session."""


class NotTheirsError(RefusalError):
    """The trial is not one of this study session."""


class ConflictError(RefusalError):
    """The request does not fit the state of the study session."""


class StudyFullError(ConflictError):
    """No place is open."""


class CrowdedAddressError(StudyFullError):
    """Too many newcomers have come from one network address."""


class UnprovenError(RefusalError):
    """Nothing proves that the study session belongs to this person."""


class TakenPartError(UnprovenError):
    """It is over, besides."""


class UninvitedError(RefusalError):
    """The study takes only participants whom its channel names."""


class UnacceptableError(RefusalError):
    """An answer is missing or out of range, or a video has not been watched yet."""


class TooMuchWatchedError(UnacceptableError):
    """More was reported as played than is possible."""


class IneligibleError(Exception):
    """The answers to the questions of `stage` do not let somebody take part."""

    def __init__(self, stage: Stage) -> None:
        super().__init__(stage)
        self.stage = stage


MAX_LOGGED: Final = 100
"""Refusals logged for one study session, and for all addresses that belong to nobody."""

MAX_DETAIL_LENGTH: Final = 300

KINDS: Final[Mapping[type[RefusalError], str]] = {
    UnknownAddressError: "unknown-address",
    NotTheirsError: "not-theirs",
    ConflictError: "stale-page",
    UnacceptableError: "unacceptable",
    TooMuchWatchedError: "too-much-watched",
}
"""The logged refusals. A full study and an ineligible participant are nobody's mistakes."""

LOG: Final = logging.getLogger(__name__)


def log_refusal(
    database: Database, token: str, request: str, refusal: RefusalError, clock: Clock
) -> None:
    """Store a refusal in a transaction of its own; a failure to do so is only logged.

    At most `MAX_LOGGED` of a study session are stored, or a few more of simultaneous requests.

    Parameters
    ----------
    token : str
        The study session whose page made the request; it is not stored.
    request : str
        The request in one word.
    """
    kind = KINDS.get(type(refusal))
    if kind is None:
        return
    try:
        with database.reading() as session:
            number = session.scalar(select(StudySession.id).where(StudySession.token == token))
            column = RefusalLine.study_session_id
            same: ColumnElement[bool] = column.is_(None) if number is None else column == number
            logged = session.scalar(select(func.count()).select_from(RefusalLine).where(same)) or 0
        if logged >= MAX_LOGGED:
            return
        detail = f"{request}: {refusal.what}"[:MAX_DETAIL_LENGTH]
        line = RefusalLine(at=clock.now(), study_session_id=number, kind=kind, detail=detail)
        with database.writing() as session:
            session.add(line)
    except SQLAlchemyError:
        LOG.exception("A refusal could not be noted")
