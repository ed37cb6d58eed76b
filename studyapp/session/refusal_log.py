"""Noting what was refused, so that a participant's trouble can be looked into afterwards."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Final

from sqlalchemy import ColumnElement, func, select
from sqlalchemy.exc import SQLAlchemyError

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import RefusalLine, StudySession
from studyapp.session.refusal import (
    ConflictError,
    NotTheirsError,
    RefusalError,
    TooMuchWatchedError,
    UnacceptableError,
    UnknownAddressError,
)

MOST_OF_ONE: Final = 100
"""Refusals noted of one study session; more of them tell nothing new."""

MOST_OF_NOBODY: Final = 500
"""Refusals noted of addresses that belong to nobody: mostly mistyped, some of them guessed."""

LONGEST: Final = 300

KINDS: Final[Mapping[type[RefusalError], str]] = {
    UnknownAddressError: "unknown-address",
    NotTheirsError: "not-theirs",
    ConflictError: "stale-page",
    UnacceptableError: "unacceptable",
    TooMuchWatchedError: "too-much-watched",
}
"""What is noted, and as what. A study that is full or looks for other people refuses nothing
that anybody did wrong."""

LOG: Final = logging.getLogger(__name__)


def note_refusal(
    database: Database, token: str, asked: str, refusal: RefusalError, clock: Clock
) -> None:
    """Store what was refused, in a transaction of its own; that it fails changes nothing.

    At most `MOST_OF_ONE` of a study session are stored, a few more where requests come at once.

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
            of = session.scalar(select(StudySession.id).where(StudySession.token == token))
            whose = RefusalLine.study_session_id
            same: ColumnElement[bool] = whose.is_(None) if of is None else whose == of
            noted = session.scalar(select(func.count()).select_from(RefusalLine).where(same)) or 0
        if noted >= (MOST_OF_NOBODY if of is None else MOST_OF_ONE):
            return
        detail = f"{asked}: {refusal.what}"[:LONGEST]
        line = RefusalLine(at=clock.now(), study_session_id=of, kind=kind, detail=detail)
        with database.writing() as session:
            session.add(line)
    except SQLAlchemyError:
        LOG.exception("A refusal could not be noted")
