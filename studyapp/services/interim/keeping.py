"""Keeping what was computed, so that nothing is computed twice, nor twice at once.

All of it is in the database: any process of any host may ask, and any may go away meanwhile.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from threading import Thread
from typing import Final

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.models import AuditLine, InterimFigures, StudySession
from studyapp.services.database import Database, Turn, take_turn
from studyapp.services.interim.documents import What
from studyapp.services.looks import EVENTS, answers_so_far

RESTS: Final[dict[What, timedelta]] = {
    "agreement": timedelta(minutes=10),
    "results": timedelta(minutes=1),
}
"""However many answers come in between, nothing is computed more often."""

GIVEN_UP_AFTER: Final = timedelta(minutes=5)
"""Whoever began to compute longer ago has gone away."""

Compute = Callable[[What], str]


@dataclass(frozen=True, kw_only=True)
class Kept:
    """What is known of one kind of figures.

    Attributes
    ----------
    document : str
        As it was computed last; empty where it never was.
    is_current : bool
        Whether nothing has changed since.
    is_awaited : bool
        Whether it is being computed.
    problem : str
        Why the last attempt failed; empty where it did not.
    """

    document: str
    is_current: bool
    is_awaited: bool
    problem: str


def kept_figures(database: Database, clock: Clock, what: What, compute: Compute) -> Kept:
    """Return what was computed last, and have it computed anew where that is due.

    Computing goes on after this returns.

    Parameters
    ----------
    compute : callable
        Gives the document, or raises `InputError`; called in a thread of its own.
    """
    now = clock.now()
    with database.reading() as session:
        state = _state(session)
        row = _row(session, what)
    if _is_due(row, state, now, RESTS[what]) and (begun := _begin(database, what, state, now)):
        Thread(
            target=_fill, args=(database, clock, what, begun, compute), name=what, daemon=True
        ).start()
        return _kept(row, state, is_awaited=True)
    return _kept(row, state, is_awaited=row is not None and _is_running(row, now))


def _kept(row: InterimFigures | None, state: str, *, is_awaited: bool) -> Kept:
    if row is None:
        return Kept(document="", is_current=False, is_awaited=is_awaited, problem="")
    return Kept(
        document=row.document,
        is_current=row.state == state,
        is_awaited=is_awaited,
        problem=row.problem,
    )


def _state(session: Session) -> str:
    """Return what figures depend on: answers, who is counted, and what researchers changed."""
    changes = select(func.max(AuditLine.id)).where(AuditLine.event.not_in(EVENTS.values()))
    people = select(func.count(StudySession.completed_at), func.count(StudySession.withdrawn_at))
    finished, withdrawn = session.execute(people).one()
    return f"{answers_so_far(session)}-{finished}-{withdrawn}-{session.scalar(changes) or 0}"


def _row(session: Session, what: What) -> InterimFigures | None:
    return session.scalars(select(InterimFigures).where(InterimFigures.what == what)).first()


def _is_running(row: InterimFigures, now: datetime) -> bool:
    return row.begun_at is not None and now - row.begun_at < GIVEN_UP_AFTER


def _is_due(row: InterimFigures | None, state: str, now: datetime, rest: timedelta) -> bool:
    if row is None or row.tried_at is None:
        return row is None or not _is_running(row, now)
    changed = row.state != state or bool(row.problem)
    return changed and now - row.tried_at >= rest and not _is_running(row, now)


def _begin(database: Database, what: What, state: str, now: datetime) -> datetime | None:
    """Claim the computing for this process; None where another one was first."""
    with database.writing() as session:
        take_turn(session.connection(), Turn.FIGURES)
        row = _row(session, what)
        if not _is_due(row, state, now, RESTS[what]):
            return None
        if row is None:
            row = InterimFigures(what=what, state="", document="", problem="")
            session.add(row)
        row.begun_at = now
        return now


def _fill(database: Database, clock: Clock, what: What, begun: datetime, compute: Compute) -> None:
    """Compute, and keep what comes of it."""
    with database.reading() as session:
        state = _state(session)
    try:
        values = {"document": compute(what), "state": state, "problem": ""}
    except InputError as error:
        values = {"problem": str(error)}
    with database.writing() as session:
        session.execute(
            update(InterimFigures)
            # Somebody may have been forgotten meanwhile: then it is kept no longer.
            .where(InterimFigures.what == what, InterimFigures.begun_at == begun)
            .values(begun_at=None, tried_at=clock.now(), **values)
        )
