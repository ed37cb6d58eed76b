"""Whether newcomers are let in, and how many places there are, as researchers decide it.

A running study can be paused, resumed, extended and closed. Whoever has a place keeps it, whatever
is decided.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Final, Literal, cast, get_args

from sqlalchemy import select, text
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.postgresql import Turn, share_turn, take_turn
from studyapp.database.tables import Event, IntakeChange, Place
from studyapp.researchers.audit import EVENT_LABELS, log_change, read_reason
from studyapp.session.served_study import ServedStudy

IntakeState = Literal["open", "paused", "closed"]
STATES: Final[tuple[IntakeState, ...]] = get_args(IntakeState)


@dataclass(frozen=True, kw_only=True)
class Intake:
    """What researchers have decided; see `studyapp.database.tables.IntakeChange`."""

    state: IntakeState = "open"
    more_places: int = 0


NEWEST: Final = select(IntakeChange.id).order_by(IntakeChange.id.desc()).limit(1)
NEWEST_STATE: Final = NEWEST.with_only_columns(IntakeChange.state).scalar_subquery()
NEWEST_MORE_PLACES: Final = NEWEST.with_only_columns(IntakeChange.more_places).scalar_subquery()


def current_intake(session: Session) -> Intake:
    """Return what holds now."""
    return intake_of(*session.execute(select(NEWEST_STATE, NEWEST_MORE_PLACES)).one())


def intake_of(state: str | None, more_places: int | None) -> Intake:
    """Return the newest decision; None stands for both where there was none."""
    if state is None or more_places is None:
        return Intake()
    return Intake(state=cast(IntakeState, state), more_places=more_places)


def wanted_places(served: ServedStudy, intake: Intake) -> Mapping[tuple[str, str], int]:
    """Return how many places each arm wants, by its name and design."""
    return {key: arm.places + intake.more_places for key, arm in served.arms.items()}


def open_places(session: Session, served: ServedStudy) -> None:
    """Add the places that the study asks for and the database does not have yet."""
    for (name, design), wanted in wanted_places(served, current_intake(session)).items():
        present = set(
            session.scalars(select(Place.number).where(Place.arm == name, Place.design == design))
        )
        session.add_all(
            Place(arm=name, design=design, number=number)
            for number in range(wanted)
            if number not in present
        )
    session.flush()
    # The planner would take a new table for a small one, and read all places at each arrival.
    session.execute(text("ANALYZE places"))


def take_allocation_turn(session: Session) -> None:
    """Wait until nobody is being given a place; until stored, nobody else is.

    For what changes the places themselves or looks at all of them; newcomers share the turn.
    Whoever waits for this may hold their own study session's row; whoever has or shares it must
    therefore wait for no study session.
    """
    take_turn(session.connection(), Turn.ALLOCATION)


def share_allocation_turn(session: Session, newcomer: str) -> None:
    """Wait until nobody has the allocation's turn, or arrives as the same `newcomer`."""
    share_turn(session.connection(), Turn.ALLOCATION, newcomer)


MAX_ADDED_PLACES: Final = 1000

EVENTS: Final[dict[IntakeState, Event]] = {
    "open": Event.NEWCOMERS_LET_IN,
    "paused": Event.NEWCOMERS_PAUSED,
    "closed": Event.NEWCOMERS_CLOSED,
}


def intake_changes(database: Database) -> Sequence[IntakeChange]:
    """Return what has been decided about newcomers, the newest first."""
    query = select(IntakeChange).order_by(IntakeChange.id.desc())
    with database.reading() as session:
        return session.scalars(query).all()


def change_intake(
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
        before = current_intake(session)
        if before.state == state:
            raise InputError(
                f"it is so already: {EVENT_LABELS[EVENTS[state]]}",
                remedy="Somebody else may have decided it",
            )
        after = Intake(state=state, more_places=before.more_places)
        _store_change(session, served, clock.now(), after, EVENTS[state], by=by, reason=reason)


def add_places(
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
        before = current_intake(session)
        if not 1 <= more <= MAX_ADDED_PLACES - before.more_places:
            raise InputError(
                f"{more} is no number of places to add",
                remedy=f"Give one from 1 to {max(1, MAX_ADDED_PLACES - before.more_places)}",
            )
        after = Intake(state=before.state, more_places=before.more_places + more)
        detail = f"by {more} {'place' if more == 1 else 'places'} an arm"
        _store_change(
            session, served, clock.now(), after, Event.EXTENDED, by=by, reason=reason, detail=detail
        )


def _store_change(
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
    reason = read_reason(reason)
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
