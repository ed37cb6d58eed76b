"""Finishing: the completion code and what the recruiter is told, once everything is answered."""

from __future__ import annotations

from datetime import datetime
from typing import Final

from sqlalchemy.orm import Session

from studyapp.database.tables import StudySession
from studyapp.session.exclusion import failures, is_excluded
from studyapp.session.state import current_trial, form_due, note
from studyapp.study.completion_codes import draw_code
from studyapp.study.settings.study import Study

FEWEST_LEFT_OUT: Final = 2
ONE_LEFT_OUT_IN: Final = 10


def most_left_out(trials: int) -> int:
    """Return how many of so many trials may be left out since a video does not play."""
    return max(FEWEST_LEFT_OUT, trials // ONE_LEFT_OUT_IN)


def end_unwatched(session: Session, study_session: StudySession, now: datetime) -> None:
    """End a study session in which too many videos did not play; its place is free again.

    There is no completion code: whether it is paid is for a person to decide.
    """
    note(session, study_session, last_active_at=now, outcome="unwatched")
    study_session.place = None


def move_on(session: Session, study_session: StudySession, study: Study, now: datetime) -> None:
    """Note the activity; after the last answer of all, complete the study session.

    Where the study says so, who is excluded opens the place again for somebody else.
    """
    note(session, study_session, last_active_at=now)
    if study_session.started_at is None or current_trial(study_session) is not None:
        return
    if form_due(study_session, study) is None:
        study_session.completed_at = now
        study_session.completion_code = draw_code()
        failed = failures(study, study_session.trials)["attention"]
        study_session.outcome = study.recruitment.outcome(failed)
        if study.replace_excluded and is_excluded(study, study_session):
            study_session.place = None
