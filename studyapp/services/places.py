"""Places: opening, claiming and giving back. A place is never held by two study sessions."""

from __future__ import annotations

import secrets
from datetime import datetime, timedelta

from sqlalchemy import ColumnElement, Select, func, not_, select, update
from sqlalchemy.orm import Session

from studyapp.models import Place, StudySession
from studyapp.services.database import Turn, take_turn
from studyapp.services.intake import present_intake, wanted_places
from studyapp.services.served_study import ServedStudy

ArmKey = tuple[str, str]
"""An arm's name, and the digest of what its participants are asked."""


def open_places(session: Session, served: ServedStudy) -> None:
    """Add the places that the study asks for and the database does not have yet."""
    for (name, design), wanted in wanted_places(served, present_intake(session)).items():
        present = set(
            session.scalars(select(Place.number).where(Place.arm == name, Place.design == design))
        )
        session.add_all(
            Place(arm=name, design=design, number=number)
            for number in range(wanted)
            if number not in present
        )
    session.flush()


def take_allocation_turn(session: Session) -> None:
    """Wait until no other process gives places to participants; until stored, nobody else does.

    Whoever waits for this may hold their own study session's row; whoever has it must therefore
    wait for no study session.
    """
    take_turn(session.connection(), Turn.ALLOCATION)


def release_stale(session: Session, served: ServedStudy, now: datetime) -> None:
    """Give back the places of unfinished study sessions that have been silent for too long.

    Those are passed over that another transaction is at work on: they are silent no longer.
    """
    stale = session.scalars(
        select(StudySession.id)
        .join(StudySession.place)
        .where(_is_stale(served, now))
        .with_for_update(of=StudySession, skip_locked=True)
    ).all()
    session.execute(
        update(Place).where(Place.study_session_id.in_(stale)).values(study_session_id=None)
    )


def least_filled(session: Session, served: ServedStudy) -> Place | None:
    """Return an open place of the arm with the fewest held ones, None if all are full.

    Places of completed and of active study sessions count as held, stale ones are given back
    before. Among equally filled arms chance decides. To be called in the allocation's turn.
    """
    held = _held(session)
    wanted = wanted_places(served, present_intake(session))
    wanting = {key: held.get(key, 0) for key, most in wanted.items() if held.get(key, 0) < most}
    if not wanting:
        return None
    fewest = min(wanting.values())
    arm = secrets.choice([key for key, count in wanting.items() if count == fewest])
    # Fewer are held than there are places, so one with a number below that is open.
    return _first(session, _open(arm))


def has_open_place(session: Session, served: ServedStudy, now: datetime) -> bool:
    """Tell whether there is a place for a newcomer, as far as can be said outside the turn.

    Places of stale study sessions count as open, though they are given back later.
    """
    active = select(StudySession.id).where(not_(_is_stale(served, now)))
    held = _held(session, Place.study_session_id.in_(active))
    wanted = wanted_places(served, present_intake(session))
    return any(held.get(key, 0) < most for key, most in wanted.items())


def regain_place(session: Session, served: ServedStudy, study_session: StudySession) -> None:
    """Give a participant back the place that was lost to a pause, if nobody else has it now.

    No other place will do: its trials are other ones. And none where the study has changed
    since, as its pages would no longer fit the trials, or where it wants no more participants.
    """
    over = study_session.withdrawn_at is not None or study_session.completed_at is not None
    key = (study_session.arm, study_session.arm_design)
    if over or study_session.place is not None or key not in served.arms:
        return
    take_allocation_turn(session)
    if _held(session).get(key, 0) < wanted_places(served, present_intake(session))[key]:
        own = _open(key).where(Place.number == study_session.number)
        study_session.place = _first(session, own)
        session.flush()


def _is_stale(served: ServedStudy, now: datetime) -> ColumnElement[bool]:
    """Return the condition that a study session is unfinished and was silent for too long."""
    silent_since = now - timedelta(minutes=served.study.lease_minutes)
    return StudySession.completed_at.is_(None) & (StudySession.last_active_at < silent_since)


def _held(session: Session, *which: ColumnElement[bool]) -> dict[ArmKey, int]:
    """Return how many places of each arm are held, by whoever has finished or is active."""
    rows = session.execute(
        select(Place.arm, Place.design, func.count())
        .where(Place.study_session_id.is_not(None), *which)
        .group_by(Place.arm, Place.design)
    )
    return {(arm, design): count for arm, design, count in rows}


def _open(key: ArmKey) -> Select[Place]:
    """Select the open places of an arm, the smallest number first."""
    arm, design = key
    return (
        select(Place)
        .where(Place.arm == arm, Place.design == design, Place.study_session_id.is_(None))
        .order_by(Place.number)
    )


def _first(session: Session, places: Select[Place]) -> Place | None:
    return session.scalars(places.limit(1)).first()


def release_outdated(session: Session, served: ServedStudy) -> None:
    """Give back the places of unfinished study sessions of arms that are no longer the same."""
    unfinished = select(StudySession.id).where(StudySession.completed_at.is_(None))
    held = select(Place.arm, Place.design).where(Place.study_session_id.is_not(None)).distinct()
    for arm, design in session.execute(held).all():
        if (arm, design) not in served.arms:
            session.execute(
                update(Place)
                .where(
                    Place.arm == arm,
                    Place.design == design,
                    Place.study_session_id.in_(unfinished),
                )
                .values(study_session_id=None)
            )
