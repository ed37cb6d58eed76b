"""Intake: researchers pause, resume, extend and close a running study.

Participants who have a place keep it in any case.
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
from studyapp.database.tables.researchers import Event
from studyapp.database.tables.study_session import IntakeChange, Place
from studyapp.researchers.audit import EVENT_LABELS, log_change, read_reason
from studyapp.session.served_study import ServedStudy
from studyapp.study.settings.study import Study

IntakeState = Literal["open", "paused", "closed"]
STATES: Final[tuple[IntakeState, ...]] = get_args(IntakeState)


@dataclass(frozen=True, kw_only=True)
class Intake:
    """The researchers' decision; see `studyapp.database.tables.study_session.IntakeChange`."""

    state: IntakeState = "open"
    more_places: int = 0


def current_intake(session: Session) -> Intake:
    """Return the current decision."""
    query = select(IntakeChange).order_by(IntakeChange.id.desc()).limit(1)
    newest = session.scalars(query).first()
    if newest is None:
        return Intake()
    return Intake(state=cast(IntakeState, newest.state), more_places=newest.more_places)


def is_closed(database: Database, study: Study) -> bool:
    """Return whether the study is closed to newcomers, by its file or a researcher."""
    with database.reading() as session:
        return not study.open or current_intake(session).state == "closed"


def wanted_places(served: ServedStudy, intake: Intake) -> Mapping[tuple[str, str], int]:
    """Return the number of places of each arm, by its name and design."""
    return {key: arm.places + intake.more_places for key, arm in served.arms.items()}


def open_places(session: Session, served: ServedStudy) -> None:
    """Add the places that the study needs and the database lacks."""
    for (name, design), wanted in wanted_places(served, current_intake(session)).items():
        query = select(Place.number).where(Place.arm == name, Place.design == design)
        session.add_all(
            Place(arm=name, design=design, number=number)
            for number in set(range(wanted)) - set(session.scalars(query))
        )
    session.flush()
    # Without statistics, the planner would scan all places at each arrival.
    session.execute(text("ANALYZE places"))


def take_allocation_turn(session: Session) -> None:
    """Exclude all allocation of places until the transaction ends.

    For changing places or reading all of them; newcomers share the turn. A transaction may wait
    for the turn while it locks its own study session, so nobody who has or shares the turn may
    wait for a study session.
    """
    take_turn(session.connection(), Turn.ALLOCATION)


def share_allocation_turn(session: Session, newcomer: str) -> None:
    """Exclude `take_allocation_turn`, and the same `newcomer`, until the transaction ends."""
    share_turn(session.connection(), Turn.ALLOCATION, newcomer)


MAX_ADDED_PLACES: Final = 1000

EVENTS: Final[dict[IntakeState, Event]] = {
    "open": Event.NEWCOMERS_LET_IN,
    "paused": Event.NEWCOMERS_PAUSED,
    "closed": Event.NEWCOMERS_CLOSED,
}


def intake_changes(database: Database) -> Sequence[IntakeChange]:
    """Return all decisions about newcomers, the newest first."""
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
    """Open, pause or close the study to newcomers.

    Raises
    ------
    InputError
        If no reason is given, or the study already is in that state.
    """
    with database.writing() as session:
        take_allocation_turn(session)
        before = current_intake(session)
        if before.state == state:
            raise InputError(
                f"this is the case already: {EVENT_LABELS[EVENTS[state]]}",
                remedy="Somebody else may have changed it",
            )
        after = Intake(state=state, more_places=before.more_places)
        _store_change(session, served, clock.now(), after, EVENTS[state], by=by, reason=reason)


def add_places(
    database: Database, served: ServedStudy, clock: Clock, more: int, *, by: str, reason: str
) -> None:
    """Add `more` places to every arm.

    Raises
    ------
    InputError
        If no reason is given, or `more` is out of range.
    """
    with database.writing() as session:
        take_allocation_turn(session)
        before = current_intake(session)
        if not 1 <= more <= MAX_ADDED_PLACES - before.more_places:
            raise InputError(
                f"{more} is not a number of places to add",
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
