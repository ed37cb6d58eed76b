"""Logins: which browsers a researcher is logged in with. They are kept here, not in the browser."""

from __future__ import annotations

from datetime import datetime, timedelta
from typing import Final

from sqlalchemy import ColumnElement, delete, or_, select, update
from sqlalchemy.orm import Session

from studyapp.clock import has_passed
from studyapp.database.engine import Database
from studyapp.database.tables import Researcher, ResearcherLogin
from studyapp.researchers.account import Account, account_of
from studyapp.researchers.tokens import new_token, token_hash

IDLE: Final = timedelta(hours=1)
"""Without a page asked for by hand; what a page asks for by itself does not count."""

LONGEST: Final = timedelta(hours=12)
"""However busy: a working day."""

NOTED_AFTER: Final = timedelta(minutes=1)
"""Activity is stored no more often."""


def begin_login(session: Session, researcher_id: int, now: datetime) -> str:
    """Return the token of a new login, which nobody has seen before."""
    session.execute(delete(ResearcherLogin).where(_is_over(now)))
    token = new_token()
    session.add(
        ResearcherLogin(
            researcher_id=researcher_id,
            token_hash=token_hash(token),
            began_at=now,
            last_active_at=now,
        )
    )
    return token


def logged_in(database: Database, token: str, now: datetime, *, by_hand: bool) -> Account | None:
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
    if by_hand and has_passed(NOTED_AFTER, last_active_at, now):
        with database.writing() as session:
            session.execute(
                update(ResearcherLogin)
                .where(ResearcherLogin.id == login)
                .values(last_active_at=now)
            )
    return account_of(researcher)


def end_login(database: Database, token: str) -> None:
    """Log out: the token is worth nothing from here on, in whichever browser."""
    with database.writing() as session:
        session.execute(
            delete(ResearcherLogin).where(ResearcherLogin.token_hash == token_hash(token))
        )


def end_logins_of(session: Session, researcher_id: int) -> None:
    """Log a researcher out everywhere."""
    session.execute(delete(ResearcherLogin).where(ResearcherLogin.researcher_id == researcher_id))


def _is_over(now: datetime) -> ColumnElement[bool]:
    return or_(
        ResearcherLogin.began_at <= now - LONGEST, ResearcherLogin.last_active_at <= now - IDLE
    )
