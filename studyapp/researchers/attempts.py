"""Limiting login attempts, so that nobody can guess passwords.

Attempts are counted in the database for all server processes, by network address and by address
and name, so that strangers elsewhere lock nobody out. They are counted before the password is
compared, so that simultaneous attempts get no further than successive ones.
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
"""Higher, as a whole institute may share one."""


class TooManyAttemptsError(InputError):
    """Logins from this address, or with this name from it, are blocked for some `seconds`."""

    def __init__(self, seconds: int) -> None:
        self.seconds = seconds
        minutes = math.ceil(seconds / 60)
        super().__init__(
            "there were too many attempts to log in",
            remedy=f"Try again in {minutes} {'minute' if minutes == 1 else 'minutes'}, or ask an "
            "owner for a link to set a new password",
        )


def count_attempt(database: Database, name_hash: str, address: str, now: datetime) -> None:
    """Count one more attempt.

    Raises
    ------
    TooManyAttemptsError
        If there were too many with this name from this address, or from this address at all; this
        one is then not counted, so that waiting helps.
    """
    # Reading first: floods of attempts must not block participants' writes.
    with database.reading() as session:
        _require_few_attempts(session, name_hash, address, now)
    with database.writing() as session:
        take_turn(session.connection(), Turn.LOGIN)
        _require_few_attempts(session, name_hash, address, now)
        session.execute(delete(LoginAttempt).where(~_is_recent(now)))
        session.add(LoginAttempt(at=now, name_hash=name_hash, address=address))


def forget_attempts(session: Session, name_hash: str, address: str) -> None:
    """Forget the attempts with a name from `address`, after the right password."""
    session.execute(delete(LoginAttempt).where(_of_name_and_address(name_hash, address)))


def forget_all_attempts(session: Session, name_hash: str) -> None:
    """Forget all attempts with a name, after a change of the password."""
    session.execute(delete(LoginAttempt).where(LoginAttempt.name_hash == name_hash))


def _of_name_and_address(name_hash: str, address: str) -> ColumnElement[bool]:
    return and_(LoginAttempt.name_hash == name_hash, LoginAttempt.address == address)


def _is_recent(now: datetime) -> ColumnElement[bool]:
    """Return the condition that an attempt counts; one before a clock was set back does not."""
    return and_(LoginAttempt.at > now - WINDOW, LoginAttempt.at <= now + APART)


def _require_few_attempts(session: Session, name_hash: str, address: str, now: datetime) -> None:
    for condition, limit in (
        (_of_name_and_address(name_hash, address), MAX_ATTEMPTS_PER_NAME),
        (LoginAttempt.address == address, MAX_ATTEMPTS_PER_ADDRESS),
    ):
        end = _end_of_lockout(session, condition, limit, now)
        if end is not None:
            raise TooManyAttemptsError(max(1, math.ceil((end - now).total_seconds())))


def _end_of_lockout(
    session: Session, condition: ColumnElement[bool], limit: int, now: datetime
) -> datetime | None:
    """Return when fewer than `limit` attempts will count; None if fewer count now."""
    counted = (
        select(LoginAttempt.at)
        .where(condition, _is_recent(now))
        .order_by(LoginAttempt.at.desc())
        .offset(limit - 1)
        .limit(1)
    )
    oldest = session.scalar(counted)
    return None if oldest is None else oldest + WINDOW
