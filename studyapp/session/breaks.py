"""Breaks in long studies: offered between trials, left when the participant is ready."""

from __future__ import annotations

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import StudySession
from studyapp.session.arrival.places import regain_place
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import current_trial, find, state_of
from studyapp.study.settings.study import Study


def break_due(study_session: StudySession, study: Study) -> int | None:
    """Return the position of the trial that a break comes before now, if one does.

    A trial that was shown already is gone on with: nobody is sent away from it.
    """
    trial = current_trial(study_session)
    if state_of(study_session) != "started" or trial is None or trial.shown_at is not None:
        return None
    rested = (study_session.rested_at_position or 0) >= trial.position
    if rested or not study.page.break_after(trial.position - 1, len(study_session.trials)):
        return None
    return trial.position


def leave_break(
    database: Database, served: ServedStudy, token: str, position: int, clock: Clock
) -> None:
    """End the break before the trial at `position`; any other than the present one is over."""
    with database.writing() as session:
        study_session = find(session, token)
        regain_place(session, served, study_session)
        if break_due(study_session, served.study) == position:
            study_session.rested_at_position = position
            study_session.last_active_at = clock.now()
