"""Logging in with name and password, and the logins that last from then on.

Which browsers a researcher is logged in with is kept here, not in the browser.
"""

from __future__ import annotations

from datetime import datetime, timedelta
from typing import Final

from sqlalchemy import ColumnElement, delete, or_, select, update
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock, has_passed
from studyapp.database.engine import Database
from studyapp.database.tables import Event, Researcher, ResearcherLogin
from studyapp.researchers.account import Account, account_of, end_logins, name_hash, name_key
from studyapp.researchers.attempts import (
    count_attempt,
    forget_all_attempts,
    forget_attempts,
)
from studyapp.researchers.audit import log_change, read_reason
from studyapp.researchers.credentials import (
    accept_code,
    check_password,
    hash_password,
    needs_rehash,
    new_token,
    token_hash,
    verify_password,
)

MAX_IDLE: Final = timedelta(hours=1)
"""Without a page asked for by hand; what a page asks for by itself does not count."""

MAX_DURATION: Final = timedelta(hours=12)
"""However busy: a working day."""

ACTIVITY_INTERVAL: Final = timedelta(minutes=1)
"""Activity is stored no more often."""


def begin_login(
    session: Session, researcher_id: int, now: datetime, token: str | None = None
) -> str:
    """Return the token of a new login, which nobody has seen before.

    Parameters
    ----------
    token : str, optional
        Of a login that follows from another one, in place of one that is drawn.
    """
    session.execute(delete(ResearcherLogin).where(_is_over(now)))
    token = token or new_token()
    session.add(
        ResearcherLogin(
            researcher_id=researcher_id,
            token_hash=token_hash(token),
            began_at=now,
            last_active_at=now,
        )
    )
    return token


def find_account_by_login(
    database: Database, token: str, now: datetime, *, by_hand: bool
) -> Account | None:
    """Return who is logged in with `token`, None where nobody is, or no longer.

    Parameters
    ----------
    by_hand : bool
        Whether the researcher asked; False where a page refreshes itself.
    """
    query = (
        select(ResearcherLogin.id, ResearcherLogin.last_active_at, Researcher)
        .join(Researcher, Researcher.id == ResearcherLogin.researcher_id)
        .where(
            ResearcherLogin.token_hash == token_hash(token),
            ~_is_over(now),
            Researcher.disabled_at.is_(None),
        )
    )
    with database.reading() as session:
        found = session.execute(query).first()
    if found is None:
        return None
    login, last_active_at, researcher = found
    if by_hand and has_passed(ACTIVITY_INTERVAL, last_active_at, now):
        with database.writing() as session:
            session.execute(
                update(ResearcherLogin)
                .where(ResearcherLogin.id == login)
                .values(last_active_at=now)
            )
    return account_of(researcher)


def end_login(database: Database, *tokens: str) -> None:
    """Log out: the tokens are worth nothing from here on, in whichever browser."""
    with database.writing() as session:
        session.execute(
            delete(ResearcherLogin).where(ResearcherLogin.token_hash.in_(map(token_hash, tokens)))
        )


def _is_over(now: datetime) -> ColumnElement[bool]:
    return or_(
        ResearcherLogin.began_at <= now - MAX_DURATION,
        ResearcherLogin.last_active_at <= now - MAX_IDLE,
    )


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
        found = _find_by_name(session, name)
    right = verify_password(None if found is None else found.password_hash, password)
    if found is None or not right or found.disabled_at is not None:
        raise WrongLoginError
    better = hash_password(password) if needs_rehash(found.password_hash) else None
    with database.writing() as session:
        researcher = _lock_unchanged(session, found)
        if not accept_code(researcher, code, now):
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
    if not verify_password(found.password_hash, old):
        raise InputError("the old password is not right", remedy="Type it once more")
    check_password(new, name=found.name)
    password_hash = hash_password(new)
    with database.writing() as session:
        researcher = _lock_unchanged(session, found)
        return set_password(session, researcher, password_hash, now)


def set_password(
    session: Session, researcher: Researcher, password_hash: str, now: datetime
) -> str:
    """Store a new password, end all logins with the old one, and return a new login's token."""
    researcher.password_hash = password_hash
    end_logins(session, researcher.id)
    forget_all_attempts(session, name_hash(researcher.name))
    log_change(session, now, Event.PASSWORD_CHANGED, by=researcher.name)
    return begin_login(session, researcher.id, now)


def _find_by_name(session: Session, name: str) -> Researcher | None:
    return session.scalars(select(Researcher).where(Researcher.name_key == name_key(name))).first()


def _lock_unchanged(session: Session, seen: Researcher) -> Researcher:
    """Return the row of `seen`, kept from other writers, if its password is still the same one."""
    query = select(Researcher).where(Researcher.id == seen.id).with_for_update()
    found = session.scalars(query.execution_options(populate_existing=True)).first()
    same = found is not None and found.password_hash == seen.password_hash
    if found is None or not same or found.disabled_at is not None:
        raise WrongLoginError
    return found


UNBLINDED_FOR: Final = timedelta(hours=1)
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
    reason = read_reason(reason)
    with database.writing() as session:
        now = clock.now()
        session.execute(
            update(ResearcherLogin)
            .where(ResearcherLogin.token_hash == token_hash(token))
            .values(unblinded_at=now, unblinding_reason=reason)
        )
        log_change(session, now, Event.UNBLINDED, by=by, reason=reason)


def unblinding_reason(database: Database, token: str, now: datetime) -> str:
    """Return for which reason the login of `token` sees results; empty where it does not."""
    query = select(ResearcherLogin.unblinding_reason).where(
        ResearcherLogin.token_hash == token_hash(token),
        ResearcherLogin.unblinded_at > now - UNBLINDED_FOR,
    )
    with database.reading() as session:
        return session.scalars(query).first() or ""
