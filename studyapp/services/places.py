"""Places: opening, claiming and giving back. A place is never held by two study sessions."""

from __future__ import annotations

import secrets
from datetime import datetime, timedelta

from sqlalchemy import func, select, update
from sqlalchemy.orm import Session

from studyapp.definition.study import Study, comparison_name
from studyapp.models import Place, StudySession


def open_places(session: Session, study: Study) -> None:
    """Add the places that `study` asks for and the database does not have yet."""
    for other in study.others:
        comparison = comparison_name(study.reference, other)
        present = set(session.scalars(select(Place.number).where(Place.comparison == comparison)))
        session.add_all(
            Place(comparison=comparison, reference=study.reference, other=other, number=number)
            for number in range(study.participants_per_comparison)
            if number not in present
        )
    session.flush()


def release_stale(session: Session, study: Study, now: datetime) -> None:
    """Give back the places of unfinished study sessions that have been silent for too long."""
    silent_since = now - timedelta(minutes=study.lease_minutes)
    stale = select(StudySession.id).where(
        StudySession.completed_at.is_(None), StudySession.last_active_at < silent_since
    )
    session.execute(
        update(Place).where(Place.study_session_id.in_(stale)).values(study_session_id=None)
    )


def least_filled(session: Session, study: Study) -> Place | None:
    """Return an open place of the comparison with the fewest held ones, None if all are full.

    Places of completed and of active study sessions count as held, stale ones are given back
    before. Among equally filled comparisons chance decides.
    """
    held = dict.fromkeys((comparison_name(study.reference, o) for o in study.others), 0)
    counts = session.execute(
        select(Place.comparison, func.count(Place.study_session_id))
        .where(Place.number < study.participants_per_comparison)
        .group_by(Place.comparison)
    )
    held.update({comparison: count for comparison, count in counts if comparison in held})
    while held:
        fewest = min(held.values())
        comparison = secrets.choice([name for name, count in held.items() if count == fewest])
        place = open_place(session, comparison, study.participants_per_comparison)
        if place is not None:
            return place
        del held[comparison]
    return None


def open_place(session: Session, comparison: str, places: int) -> Place | None:
    """Return the first open one of the `places` places of `comparison`, None if it is full."""
    return session.scalars(
        select(Place)
        .where(
            Place.comparison == comparison,
            Place.number < places,
            Place.study_session_id.is_(None),
        )
        .order_by(Place.number)
        .limit(1)
        .with_for_update(skip_locked=True)
    ).first()


def regain_place(session: Session, study: Study, study_session: StudySession) -> None:
    """Give a participant back a place of their comparison, if one was lost and one is open."""
    if study_session.place is None and study_session.withdrawn_at is None:
        places = study.participants_per_comparison
        study_session.place = open_place(session, study_session.comparison, places)
        session.flush()
