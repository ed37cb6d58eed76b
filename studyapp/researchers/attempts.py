"""Counting attempts to log in, so that nobody can go on guessing.

They are counted in the database, so that all server processes count together, for each address and
for each name that is tried from it. What a stranger tries elsewhere locks nobody out. An attempt is
counted before the password is compared: many at once get no further than one after the other.
"""

from __future__ import annotations

import math
from datetime import datetime, timedelta
from typing import Final

from sqlalchemy import ColumnElement, and_, delete, select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import APART
from studyapp.database.engine import Database
from studyapp.database.postgresql import Turn, take_turn
from studyapp.database.tables import LoginAttempt

WINDOW: Final = timedelta(minutes=15)
MAX_ATTEMPTS_PER_NAME: Final = 10
MAX_ATTEMPTS_PER_ADDRESS: Final = 50
"""More, since a whole institute may share one."""


class TooManyAttemptsError(InputError):
    """Nobody can log in from this address, with this name or any, for a while.

    Attributes
    ----------
    seconds : int
        How long.
    """

    def __init__(self, seconds: int) -> None:
        self.seconds = seconds
        minutes = math.ceil(seconds / 60)
        super().__init__(
            "there were too many attempts to log in",
            remedy=f"Try again in {minutes} {'minute' if minutes == 1 else 'minutes'}, or have "
            "somebody make a link for a new password",
        )


def count_attempt(database: Database, name_hash: str, address: str, now: datetime) -> None:
    """Note one more attempt that may not succeed.

    Raises
    ------
    TooManyAttemptsError
        If there were as many of this name from this address, or of any, as may be; this one is not
        counted then, so that waiting is enough.
    """
    # Whoever floods the server with attempts must not keep participants from storing answers.
    with database.reading() as session:
        _require_few_attempts(session, name_hash, address, now)
    with database.writing() as session:
        take_turn(session.connection(), Turn.LOGIN)
        _require_few_attempts(session, name_hash, address, now)
        session.execute(delete(LoginAttempt).where(~_is_recent(now)))
        session.add(LoginAttempt(at=now, name_hash=name_hash, address=address))


def forget_attempts(session: Session, name_hash: str, address: str) -> None:
    """Forget the attempts with a name whose right password was given from `address`."""
    session.execute(delete(LoginAttempt).where(_of_name_and_address(name_hash, address)))


def forget_all_attempts(session: Session, name_hash: str) -> None:
    """Forget the attempts with a name that has another password now, wherever they came from."""
    session.execute(delete(LoginAttempt).where(LoginAttempt.name_hash == name_hash))


def _of_name_and_address(name_hash: str, address: str) -> ColumnElement[bool]:
    return and_(LoginAttempt.name_hash == name_hash, LoginAttempt.address == address)


def _is_recent(now: datetime) -> ColumnElement[bool]:
    """Return the condition that an attempt still counts; not so if the clock was set back since."""
    return and_(LoginAttempt.at > now - WINDOW, LoginAttempt.at <= now + APART)


def _require_few_attempts(session: Session, name_hash: str, address: str, now: datetime) -> None:
    for same, most in (
        (_of_name_and_address(name_hash, address), MAX_ATTEMPTS_PER_NAME),
        (LoginAttempt.address == address, MAX_ATTEMPTS_PER_ADDRESS),
    ):
        ends = _end_of_lockout(session, same, most, now)
        if ends is not None:
            raise TooManyAttemptsError(max(1, math.ceil((ends - now).total_seconds())))


def _end_of_lockout(
    session: Session, same: ColumnElement[bool], most: int, now: datetime
) -> datetime | None:
    """Return when fewer than `most` attempts will count, None where that is so by now."""
    counted = (
        select(LoginAttempt.at)
        .where(same, _is_recent(now))
        .order_by(LoginAttempt.at.desc())
        .offset(most - 1)
        .limit(1)
    )
    oldest = session.scalar(counted)
    return None if oldest is None else oldest + WINDOW
