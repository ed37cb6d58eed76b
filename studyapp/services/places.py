"""Places: opening, claiming and giving back. A place is never held by two study sessions."""

from __future__ import annotations

import secrets
from datetime import datetime, timedelta

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from studyapp.models import Place, StudySession
from studyapp.services.served_study import ServedStudy

ArmKey = tuple[str, str]
"""An arm's name, and the digest of what its participants are asked."""


def open_places(session: Session, served: ServedStudy) -> None:
    """Add the places that the study asks for and the database does not have yet."""
    for (name, design), arm in served.arms.items():
        present = set(
            session.scalars(select(Place.number).where(Place.arm == name, Place.design == design))
        )
        session.add_all(
            Place(arm=name, design=design, number=number)
            for number in range(arm.places)
            if number not in present
        )
    session.flush()


def release_stale(session: Session, served: ServedStudy, now: datetime) -> None:
    """Give back the places of unfinished study sessions that have been silent for too long."""
    silent_since = now - timedelta(minutes=served.study.lease_minutes)
    stale = select(StudySession.id).where(
        StudySession.completed_at.is_(None), StudySession.last_active_at < silent_since
    )
    session.execute(
        update(Place).where(Place.study_session_id.in_(stale)).values(study_session_id=None)
    )


def least_filled(session: Session, served: ServedStudy) -> Place | None:
    """Return an open place of the arm with the fewest held ones, None if all are full.

    Places of completed and of active study sessions count as held, stale ones are given back
    before. Among equally filled arms chance decides.
    """
    held = dict.fromkeys(served.arms, 0)
    taken = select(Place.arm, Place.design, Place.number).where(Place.study_session_id.is_not(None))
    for name, design, number in session.execute(taken):
        arm = served.arms.get((name, design))
        if arm is not None and number < arm.places:
            held[name, design] += 1
    while held:
        fewest = min(held.values())
        key = secrets.choice([key for key, count in held.items() if count == fewest])
        place = open_place(session, key, served.arms[key].places)
        if place is not None:
            return place
        del held[key]
    return None


def open_place(
    session: Session, key: ArmKey, places: int, *, number: int | None = None
) -> Place | None:
    """Return the first open one of the `places` places of an arm, None if there is none.

    With `number`, no other place than that one is looked at.
    """
    wanted = Place.number < places if number is None else Place.number == number
    return session.scalars(
        select(Place)
        .where(
            Place.arm == key[0], Place.design == key[1], wanted, Place.study_session_id.is_(None)
        )
        .order_by(Place.number)
        .limit(1)
        .with_for_update(skip_locked=True)
    ).first()


def regain_place(session: Session, served: ServedStudy, study_session: StudySession) -> None:
    """Give a participant back the place that was lost to a pause, if nobody else has it now.

    No other place will do: its trials are other ones. And none where the study has changed
    since: its pages would no longer fit the trials.
    """
    over = study_session.withdrawn_at is not None or study_session.completed_at is not None
    if over or study_session.place is not None:
        return
    key = (study_session.arm, study_session.arm_design)
    if key in served.arms:
        study_session.place = open_place(
            session, key, served.arms[key].places, number=study_session.number
        )
        session.flush()


def release_outdated(session: Session, served: ServedStudy) -> None:
    """Give back the places of unfinished study sessions of arms that are no longer the same."""
    unfinished = select(StudySession).where(StudySession.completed_at.is_(None))
    for study_session in session.scalars(unfinished):
        if (study_session.arm, study_session.arm_design) not in served.arms:
            study_session.place = None
    session.flush()
