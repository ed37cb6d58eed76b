"""Logging in with name and password."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import Event, Researcher
from studyapp.researchers.attempts import (
    count_attempt,
    forget_all_attempts,
    forget_attempts,
)
from studyapp.researchers.audit import log_change
from studyapp.researchers.logins import begin_login, end_logins_of
from studyapp.researchers.names import name_hash, name_key
from studyapp.researchers.passwords import (
    check_password,
    hashed,
    is_outdated,
    is_right,
)
from studyapp.researchers.second_factor import passes


class WrongLoginError(InputError):
    """Name, password and code do not go together; nobody is told which of them is wrong."""

    def __init__(self) -> None:
        super().__init__(
            "name and password do not go together, or the code is missing or was used",
            remedy="Look at all of it once more; an owner can make a link for a new password",
        )


def log_in(
    database: Database, clock: Clock, *, name: str, password: str, code: str = "", address: str
) -> str:
    """Return the token of a new login.

    Parameters
    ----------
    code : str
        Of the second factor, where the account has one, or a recovery code.

    An unknown name, a wrong password and an account that is shut out get the same answer after
    the same work.

    Raises
    ------
    WrongLoginError
        If there is no such login.
    TooManyAttemptsError
        If there were too many attempts lately; then not even the right password helps.
    """
    now = clock.now()
    count_attempt(database, name_hash(name), address, now)
    with database.reading() as session:
        found = _find(session, name)
    right = is_right(None if found is None else found.password_hash, password)
    if found is None or not right or found.disabled_at is not None:
        raise WrongLoginError
    better = hashed(password) if is_outdated(found.password_hash) else None
    with database.writing() as session:
        researcher = _unchanged(session, found)
        if not passes(researcher, code, now):
            raise WrongLoginError
        if better is not None:
            researcher.password_hash = better
        forget_attempts(session, name_hash(name), address)
        log_change(session, now, Event.LOGGED_IN, by=researcher.name)
        return begin_login(session, researcher.id, now)


def change_password(
    database: Database, clock: Clock, *, researcher_id: int, old: str, new: str, address: str
) -> str:
    """Give a researcher a new password, log them out everywhere, and return a new login's token.

    Raises
    ------
    InputError
        If `old` is not the password, or `new` may not be one.
    """
    now = clock.now()
    with database.reading() as session:
        found = session.get_one(Researcher, researcher_id)
    count_attempt(database, name_hash(found.name), address, now)
    if not is_right(found.password_hash, old):
        raise InputError("the old password is not right", remedy="Type it once more")
    check_password(new, name=found.name)
    password_hash = hashed(new)
    with database.writing() as session:
        researcher = _unchanged(session, found)
        return set_password(session, researcher, password_hash, now)


def set_password(
    session: Session, researcher: Researcher, password_hash: str, now: datetime
) -> str:
    """Store a new password, end all logins with the old one, and return a new login's token."""
    researcher.password_hash = password_hash
    end_logins_of(session, researcher.id)
    forget_all_attempts(session, name_hash(researcher.name))
    log_change(session, now, Event.PASSWORD_CHANGED, by=researcher.name)
    return begin_login(session, researcher.id, now)


def _find(session: Session, name: str) -> Researcher | None:
    return session.scalars(select(Researcher).where(Researcher.name_key == name_key(name))).first()


def _unchanged(session: Session, seen: Researcher) -> Researcher:
    """Return the row of `seen`, kept from other writers, if its password is still the same one."""
    query = select(Researcher).where(Researcher.id == seen.id).with_for_update()
    found = session.scalars(query.execution_options(populate_existing=True)).first()
    same = found is not None and found.password_hash == seen.password_hash
    if found is None or not same or found.disabled_at is not None:
        raise WrongLoginError
    return found
