"""Asking for results before the end: a reason, which holds in one login for a while."""

from __future__ import annotations

from datetime import datetime, timedelta
from typing import Final

from sqlalchemy import select, update

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import Event, ResearcherLogin
from studyapp.researchers.audit import log_change, reason_given
from studyapp.researchers.tokens import token_hash

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
