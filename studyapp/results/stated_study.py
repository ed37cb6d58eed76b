"""What a version of the study stated while nobody had taken part in it."""

from __future__ import annotations

from sqlalchemy import select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.database.tables import StudyVersion
from studyapp.study.settings.reading import parse_text
from studyapp.study.settings.study import Study


def stated_study(session: Session, version: int) -> Study | None:
    """Return `version` of the study as it was when its first participant came.

    Returns
    -------
    Study or None
        None where there is no such version, or its study file cannot be read any more.
    """
    wanted = select(StudyVersion.definition).where(StudyVersion.number == version)
    return study_of(session.scalars(wanted).first(), version)


def study_of(definition: str | None, version: int) -> Study | None:
    """Return the study that a text of `version` defines; None where it cannot be read any more."""
    if definition is None:
        return None
    try:
        return parse_text(definition, where=f"version {version}")
    except InputError:
        return None
