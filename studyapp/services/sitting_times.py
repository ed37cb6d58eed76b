"""How long those took who have finished: what a pilot tells of a study's length."""

from __future__ import annotations

from sqlalchemy import select

from studyapp.models import StudySession
from studyapp.services.database import Database


def finished_seconds(database: Database) -> tuple[float, ...]:
    """Return the seconds from agreeing to the end, of who finished and did not withdraw.

    Interruptions are in it, as they are in what recruiting sites measure.
    """
    with database.reading() as session:
        rows = session.execute(
            select(StudySession.consented_at, StudySession.completed_at)
            .where(StudySession.completed_at.is_not(None), StudySession.withdrawn_at.is_(None))
            .order_by(StudySession.id)
        ).all()
    return tuple((ended - began).total_seconds() for began, ended in rows if ended is not None)


def arrivals(database: Database) -> int:
    """Return how many have begun to take part."""
    with database.reading() as session:
        return len(session.scalars(select(StudySession.id)).all())
