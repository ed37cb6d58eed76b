"""Finishing: the completion code, which exists only when everything is answered."""

from __future__ import annotations

import secrets
from datetime import datetime
from typing import Final

from sqlalchemy.orm import Session

from studyapp.definition.study import Study
from studyapp.models import StudySession
from studyapp.services.exclusion import is_excluded
from studyapp.services.noting import note
from studyapp.services.sitting import current_trial, form_due

CODE_LETTERS: Final = "ABCDEFGHJKMNPQRTUVWXYZ2346789"
"""Letters and digits that are not taken for one another."""

CODE_LENGTH: Final = 12


def move_on(session: Session, study_session: StudySession, study: Study, now: datetime) -> None:
    """Note the activity; after the last answer of all, complete the study session.

    Where the study says so, who is excluded opens the place again for somebody else.
    """
    note(session, study_session, last_active_at=now)
    if study_session.started_at is None or current_trial(study_session) is not None:
        return
    if form_due(study_session, study) is None:
        study_session.completed_at = now
        study_session.completion_code = "".join(
            secrets.choice(CODE_LETTERS) for _ in range(CODE_LENGTH)
        )
        if study.replace_excluded and is_excluded(study, study_session):
            study_session.place = None
