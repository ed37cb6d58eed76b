"""Who belongs to the study: listing researchers, changing their roles, shutting them out."""

from __future__ import annotations

from sqlalchemy import select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import Event, Researcher
from studyapp.researchers.account import Account, Role, account_of
from studyapp.researchers.audit import log_change
from studyapp.researchers.logins import end_logins_of


def accounts(database: Database) -> list[Account]:
    """Return all researchers in the order in which they joined."""
    with database.reading() as session:
        return [
            account_of(row) for row in session.scalars(select(Researcher).order_by(Researcher.id))
        ]


def change_role(
    database: Database, clock: Clock, researcher_id: int, role: Role, *, by: str
) -> None:
    """Give a researcher another role; they have to log in again.

    Raises
    ------
    InputError
        If there is no such researcher, or nobody would be left who is an owner.
    """
    with database.writing() as session:
        researcher = _kept_from_others(session, researcher_id)
        if researcher.role == role:
            return
        if role != "owner":
            _require_another_owner(session, researcher)
        detail = f"{researcher.name}: {researcher.role} becomes {role}"
        researcher.role = role
        end_logins_of(session, researcher.id)
        log_change(session, clock.now(), Event.ROLE_CHANGED, by=by, detail=detail)


def shut_out(database: Database, clock: Clock, researcher_id: int, *, by: str) -> None:
    """Let a researcher log in no more, and end their logins; what they did stays in the log.

    Raises
    ------
    InputError
        If there is no such researcher, or nobody would be left who is an owner.
    """
    with database.writing() as session:
        researcher = _kept_from_others(session, researcher_id)
        _require_another_owner(session, researcher)
        if researcher.disabled_at is None:
            researcher.disabled_at = clock.now()
            log_change(session, clock.now(), Event.SHUT_OUT, by=by, detail=researcher.name)
        end_logins_of(session, researcher.id)


def let_in_again(database: Database, clock: Clock, researcher_id: int, *, by: str) -> None:
    """Let a researcher who was shut out log in again, with the password they had.

    Raises
    ------
    InputError
        If there is no such researcher.
    """
    with database.writing() as session:
        researcher = _kept_from_others(session, researcher_id)
        if researcher.disabled_at is not None:
            researcher.disabled_at = None
            log_change(session, clock.now(), Event.LET_IN_AGAIN, by=by, detail=researcher.name)


def _kept_from_others(session: Session, researcher_id: int) -> Researcher:
    """Return a researcher; until stored, nobody else changes who is an owner."""
    query = select(Researcher).order_by(Researcher.id).with_for_update()
    for researcher in session.scalars(query).all():
        if researcher.id == researcher_id:
            return researcher
    raise InputError("there is no such researcher", remedy="Open the list of researchers again")


def _require_another_owner(session: Session, leaving: Researcher) -> None:
    others = select(Researcher.id).where(
        Researcher.role == "owner", Researcher.disabled_at.is_(None), Researcher.id != leaving.id
    )
    if leaving.role == "owner" and session.scalar(others.limit(1)) is None:
        raise InputError(
            f"{leaving.name!r} is the only owner of the study, and there must be one",
            remedy="Make somebody else an owner first",
        )
