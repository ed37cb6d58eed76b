"""Whether people have taken part in the study as its file says it is."""

from __future__ import annotations

from sqlalchemy import select

from studyapp.models import StudySession, StudyVersion
from studyapp.services.database import Database


def answered_another_design(database: Database, design: str) -> bool:
    """Tell whether participants have come, and the last of them to another design than `design`.

    Such a study can only be served as a new version.
    """
    with database.reading() as session:
        versions = session.execute(
            select(StudyVersion.id, StudyVersion.design).order_by(StudyVersion.number)
        ).all()
        if not versions or any(version.design in (design, "") for version in versions):
            return False
        last = versions[-1].id
        seen = select(StudySession.id).where(StudySession.version_id == last).limit(1)
        return session.scalars(seen).first() is not None
