"""Intake: researchers pause, resume, extend and close a running study.

Participants who have a place keep it in any case.
"""

from collections.abc import Mapping, Sequence
from typing import Final, Literal, get_args

from sqlalchemy import select, text
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.postgresql import Turn, share_turn, take_turn
from studyapp.database.tables.researchers import Event
from studyapp.database.tables.study_session import IntakeChange, Place
from studyapp.researchers.audit import log_change, read_reason
from studyapp.session.served_study import ServedStudy
from studyapp.study.settings.study import Study

IntakeState = Literal["open", "paused", "closed"]
STATES: Final[tuple[IntakeState, ...]] = get_args(IntakeState)


DECISIONS: Final = select(IntakeChange).order_by(IntakeChange.id.desc())


def current_intake(session: Session) -> IntakeChange:
    """Return the newest decision; one that nobody had to make, before the first."""
    newest = session.scalars(DECISIONS.limit(1)).first()
    return newest or IntakeChange(state="open", more_places=0)


def is_closed(database: Database, study: Study) -> bool:
    """Return whether the study is closed to newcomers, by its file or a researcher."""
    with database.reading() as session:
        return not study.open or current_intake(session).state == "closed"


def wanted_places(served: ServedStudy, intake: IntakeChange) -> Mapping[tuple[str, str], int]:
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
    with database.reading() as session:
        return session.scalars(DECISIONS).all()


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
        If no reason is given.
    """
    with database.writing() as session:
        take_allocation_turn(session)
        more_places = current_intake(session).more_places
        change = IntakeChange(state=state, more_places=more_places, researcher=by, reason=reason)
        _store_change(session, served, clock, change, EVENTS[state])


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
        places = before.more_places + more
        change = IntakeChange(state=before.state, more_places=places, researcher=by, reason=reason)
        detail = f"by {more} {'place' if more == 1 else 'places'} an arm"
        _store_change(session, served, clock, change, Event.EXTENDED, detail)


def _store_change(
    session: Session,
    served: ServedStudy,
    clock: Clock,
    change: IntakeChange,
    event: Event,
    detail: str = "",
) -> None:
    change.at, change.reason = clock.now(), read_reason(change.reason)
    session.add(change)
    session.flush()
    log_change(session, change.at, event, by=change.researcher, detail=detail, reason=change.reason)
    open_places(session, served)
