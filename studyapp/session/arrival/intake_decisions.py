"""Pausing, resuming, extending and closing a running study: about newcomers alone.

Whoever has a place goes on and keeps it, whatever is decided.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from typing import Final

from sqlalchemy import select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import Event, IntakeChange
from studyapp.researchers.audit import WORDS, log_change, reason_given
from studyapp.session.arrival.intake import Intake, IntakeState, present_intake
from studyapp.session.arrival.places import open_places, take_allocation_turn
from studyapp.session.served_study import ServedStudy

MOST_MORE: Final = 1000

EVENTS: Final[dict[IntakeState, Event]] = {
    "open": Event.NEWCOMERS_LET_IN,
    "paused": Event.NEWCOMERS_PAUSED,
    "closed": Event.NEWCOMERS_CLOSED,
}


def decided(database: Database) -> Sequence[IntakeChange]:
    """Return what has been decided about newcomers, the newest first."""
    query = select(IntakeChange).order_by(IntakeChange.id.desc())
    with database.reading() as session:
        return session.scalars(query).all()


def steer(
    database: Database,
    served: ServedStudy,
    clock: Clock,
    state: IntakeState,
    *,
    by: str,
    reason: str,
) -> None:
    """Let newcomers in, or no longer.

    Raises
    ------
    InputError
        If no reason is given, or it is so already.
    """
    with database.writing() as session:
        take_allocation_turn(session)
        before = present_intake(session)
        if before.state == state:
            raise InputError(
                f"it is so already: {WORDS[EVENTS[state]]}",
                remedy="Somebody else may have decided it",
            )
        after = Intake(state=state, more_places=before.more_places)
        _note(session, served, clock.now(), after, EVENTS[state], by=by, reason=reason)


def extend(
    database: Database, served: ServedStudy, clock: Clock, more: int, *, by: str, reason: str
) -> None:
    """Open `more` places in every arm, beyond those that there are.

    Raises
    ------
    InputError
        If no reason is given, or `more` is no number of places.
    """
    with database.writing() as session:
        take_allocation_turn(session)
        before = present_intake(session)
        if not 1 <= more <= MOST_MORE - before.more_places:
            raise InputError(
                f"{more} is no number of places to add",
                remedy=f"Give one from 1 to {max(1, MOST_MORE - before.more_places)}",
            )
        after = Intake(state=before.state, more_places=before.more_places + more)
        detail = f"by {more} {'place' if more == 1 else 'places'} an arm"
        _note(
            session, served, clock.now(), after, Event.EXTENDED, by=by, reason=reason, detail=detail
        )


def _note(
    session: Session,
    served: ServedStudy,
    now: datetime,
    intake: Intake,
    event: Event,
    *,
    by: str,
    reason: str,
    detail: str = "",
) -> None:
    reason = reason_given(reason)
    session.add(
        IntakeChange(
            at=now,
            state=intake.state,
            more_places=intake.more_places,
            researcher=by,
            reason=reason,
        )
    )
    session.flush()
    log_change(session, now, event, by=by, detail=detail, reason=reason)
    open_places(session, served)
