"""Logging in with name and password, and the logins that follow, which are kept on the server."""

from datetime import datetime, timedelta
from typing import Final

from sqlalchemy import ColumnElement, delete, or_, select, update
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock, has_passed
from studyapp.database.engine import Database
from studyapp.database.tables.researchers import Event, Researcher, ResearcherLogin
from studyapp.researchers.account import Account, account_of, end_logins, name_hash, name_key
from studyapp.researchers.audit import log_change, read_reason
from studyapp.researchers.credentials import (
    accept_code,
    check_password,
    count_attempt,
    forget_all_attempts,
    forget_attempts,
    hash_password,
    needs_rehash,
    new_token,
    prove_password,
    token_hash,
    verify_password,
)

MAX_IDLE: Final = timedelta(hours=1)
"""A login ends after so long without a page opened by hand."""

MAX_DURATION: Final = timedelta(hours=12)
"""A login never lasts longer than a working day."""

ACTIVITY_INTERVAL: Final = timedelta(minutes=1)
"""Activity is stored at most this often."""


def begin_login(
    session: Session, researcher_id: int, now: datetime, token: str | None = None
) -> str:
    """Begin a login and return its token.

    Parameters
    ----------
    token : str, optional
        The token of a login derived from another one; by default, a new one.
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
    """Return the account that is logged in with `token`, or None.

    Parameters
    ----------
    by_hand : bool
        Whether the researcher opened a page; False if a page refreshes itself.
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
        row = session.execute(query).first()
    if row is None:
        return None
    login_id, last_active_at, researcher = row
    if by_hand and has_passed(ACTIVITY_INTERVAL, last_active_at, now):
        with database.writing() as session:
            session.execute(
                update(ResearcherLogin)
                .where(ResearcherLogin.id == login_id)
                .values(last_active_at=now)
            )
    return account_of(researcher)


def end_login(database: Database, *tokens: str) -> None:
    """End the logins with these tokens."""
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
    """Name, password or code is wrong; nobody is told which."""

    def __init__(self) -> None:
        super().__init__(
            "the name, password or code is wrong, or the code was used before",
            remedy="Check all three; an owner can create a link to set a new password",
        )


def log_in(
    database: Database, clock: Clock, *, name: str, password: str, code: str = "", address: str
) -> str:
    """Return the token of a new login.

    An unknown name, a wrong password and an account without access get the same answer after the
    same work.

    Parameters
    ----------
    code : str
        A code of the second factor, if the account has one, or a recovery code.

    Raises
    ------
    WrongLoginError
        If the login is refused.
    TooManyAttemptsError
        If there were too many attempts; then not even the right password helps.
    """
    now = clock.now()
    count_attempt(database, name_hash(name), address, now)
    query = select(Researcher).where(Researcher.name_key == name_key(name))
    with database.reading() as session:
        account = session.scalars(query).first()
    is_right = verify_password(None if account is None else account.password_hash, password)
    if account is None or not is_right or account.disabled_at is not None:
        raise WrongLoginError
    new_hash = hash_password(password) if needs_rehash(account.password_hash) else None
    with database.writing() as session:
        researcher = _lock_unchanged(session, account)
        if not accept_code(researcher, code, now):
            raise WrongLoginError
        if new_hash is not None:
            researcher.password_hash = new_hash
        forget_attempts(session, name_hash(name), address)
        log_change(session, now, Event.LOGGED_IN, by=researcher.name)
        return begin_login(session, researcher.id, now)


def change_password(
    database: Database, clock: Clock, *, researcher_id: int, old: str, new: str, address: str
) -> str:
    """Change a researcher's password, log them out everywhere, and return a new login's token.

    Raises
    ------
    InputError
        If `old` is not the password, or `new` is not acceptable.
    """
    now = clock.now()
    account = prove_password(database, researcher_id, old, address, now)
    check_password(new, name=account.name)
    password_hash = hash_password(new)
    with database.writing() as session:
        researcher = _lock_unchanged(session, account)
        return set_password(session, researcher, password_hash, now)


def set_password(
    session: Session, researcher: Researcher, password_hash: str, now: datetime
) -> str:
    """Store a new password, end all logins, and return a new login's token."""
    researcher.password_hash = password_hash
    end_logins(session, researcher.id)
    forget_all_attempts(session, name_hash(researcher.name))
    log_change(session, now, Event.PASSWORD_CHANGED, by=researcher.name)
    return begin_login(session, researcher.id, now)


def _lock_unchanged(session: Session, account: Researcher) -> Researcher:
    """Lock and return the row of `account`; its password and access must not have changed."""
    query = select(Researcher).where(Researcher.id == account.id).with_for_update()
    row = session.scalars(query.execution_options(populate_existing=True)).first()
    if row is None or row.password_hash != account.password_hash or row.disabled_at is not None:
        raise WrongLoginError
    return row


UNBLINDED_FOR: Final = timedelta(hours=1)
"""Further looks in the same login need no new reason for so long; each is logged anyway."""


def unblind(database: Database, clock: Clock, token: str, *, by: str, reason: str) -> None:
    """Let the login with `token` see results for a while; `InputError` without a reason."""
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
    """Return the reason for which the login with `token` sees results; empty if it does not."""
    query = select(ResearcherLogin.unblinding_reason).where(
        ResearcherLogin.token_hash == token_hash(token),
        ResearcherLogin.unblinded_at > now - UNBLINDED_FOR,
    )
    with database.reading() as session:
        return session.scalars(query).first() or ""
