"""What is refused to a participant, in words made for them."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Final

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.exc import SQLAlchemyError

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import RefusalLine, StudySession
from studyapp.study.settings.presentation import Message, Value


class RefusalError(Exception):
    """A request that changes nothing; what was stored before stays stored.

    Parameters
    ----------
    what : str
        What happened, as a sentence for the participant. A literal with places named ``{so}``, so
        that it can be translated.
    remedy : str
        What they can do, as a sentence, in the same way.
    **values : int, str, Message or tuple of them
        What stands in the places of both.
    """

    def __init__(self, what: str, remedy: str, /, **values: Value) -> None:
        self.messages = (Message(what, **values), Message(remedy, **values))
        super().__init__(f"{self.what} {self.remedy}")

    @property
    def what(self) -> str:
        """What happened, in English."""
        return str(self.messages[0])

    @property
    def remedy(self) -> str:
        """What they can do, in English."""
        return str(self.messages[1])


class UnknownAddressError(RefusalError):
    """There is no such study session."""


class NotTheirsError(RefusalError):
    """The trial is not one of this study session."""


class ConflictError(RefusalError):
    """The request does not fit where the study session stands."""


class LateReportError(ConflictError):
    """What was played of a trial arrived just after its end, as it does when they go on at once."""


class StudyFullError(ConflictError):
    """No place is open."""


class CrowdedAddressError(StudyFullError):
    """As many newcomers have come from one network address as may."""


class UnprovenError(RefusalError):
    """Nothing shows that this is the person who has the study session."""


class IneligibleError(RefusalError):
    """The study does not look for this person."""


class UninvitedError(RefusalError):
    """Nobody sent this person here by a name, and the study takes nobody else."""


class UnacceptableError(RefusalError):
    """An answer is missing or out of range, or the video is not yet watched."""


class TooMuchWatchedError(UnacceptableError):
    """More was reported as played than can have been."""


MAX_LOGGED: Final = 100
"""Refusals noted of one study session; more of them tell nothing new."""

MAX_LOGGED_OF_UNKNOWN: Final = 500
"""Refusals noted of addresses that belong to nobody: mostly mistyped, some of them guessed."""

MAX_DETAIL_LENGTH: Final = 300

KINDS: Final[Mapping[type[RefusalError], str]] = {
    UnknownAddressError: "unknown-address",
    NotTheirsError: "not-theirs",
    ConflictError: "stale-page",
    UnacceptableError: "unacceptable",
    TooMuchWatchedError: "too-much-watched",
}
"""What is noted, and as what. A study that is full or looks for other people refuses nothing
that anybody did wrong, nor does a report go wrong that crosses with *Next*."""

LOG: Final = logging.getLogger(__name__)


def log_refusal(
    database: Database, token: str, asked: str, refusal: RefusalError, clock: Clock
) -> None:
    """Store what was refused, in a transaction of its own; that it fails changes nothing.

    At most `MAX_LOGGED` of a study session are stored, a few more where requests come at once.

    Parameters
    ----------
    token : str
        Names the study session whose page it came from; it is not stored.
    asked : str
        What was asked for, in a word.
    """
    kind = KINDS.get(type(refusal))
    if kind is None:
        return
    try:
        with database.reading() as session:
            number = session.scalar(select(StudySession.id).where(StudySession.token == token))
            whose = RefusalLine.study_session_id
            same: ColumnElement[bool] = whose.is_(None) if number is None else whose == number
            noted = session.scalar(select(func.count()).select_from(RefusalLine).where(same)) or 0
        if noted >= (MAX_LOGGED_OF_UNKNOWN if number is None else MAX_LOGGED):
            return
        detail = f"{asked}: {refusal.what}"[:MAX_DETAIL_LENGTH]
        line = RefusalLine(at=clock.now(), study_session_id=number, kind=kind, detail=detail)
        with database.writing() as session:
            session.add(line)
    except SQLAlchemyError:
        LOG.exception("A refusal could not be noted")
