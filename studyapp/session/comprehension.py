"""Leaving the instructions: whoever shows that they were understood begins with the trials.

A study may ask a few questions under its instructions. Whoever answers them wrongly reads again and
has a second try; whoever fails both is screened out, and nothing of them stays but that they were
here, where a recruiter named them. Prolific asks for two tries.
"""

from __future__ import annotations

from collections.abc import Mapping

from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import StudySession
from studyapp.session.form_answers import is_eligible, read_form_answers
from studyapp.session.participation import sound_check_due
from studyapp.session.refusal import IneligibleError, UnacceptableError
from studyapp.session.screening import screen_out
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import find_study_session, form_due, state_of
from studyapp.study.settings.study import Study


def start_trials(
    database: Database,
    served: ServedStudy,
    token: str,
    clock: Clock,
    *,
    answers: Mapping[str, str] | None = None,
) -> None:
    """Start the trials; beginning twice changes nothing, and beginning too early neither.

    Parameters
    ----------
    answers : mapping of question name to text, optional
        To the questions under the instructions. Those of the first try are stored.

    Raises
    ------
    UnacceptableError
        If a question is left open, which is no try, or the first try was wrong.
    IneligibleError
        If the second one was, too: the study session is no more.
    """
    study, given = served.study, answers or {}
    with database.writing() as session:
        study_session = find_study_session(session, token)
        waiting = sound_check_due(study_session, served) or form_due(study_session, study)
        if state_of(study_session) != "instructed" or waiting:
            return
        now = clock.now()
        first_try = read_form_answers(study, "comprehension", given, now)
        tried = any(answer.stage == "comprehension" for answer in study_session.form_answers)
        if not tried:
            study_session.form_answers.extend(first_try)
        study_session.last_active_at = now
        if is_eligible(study, "comprehension", given):
            study_session.started_at = now
            return
        if tried:
            _screen_out(session, served.study, study_session)
    if tried:
        raise IneligibleError(
            "Thank you for your interest: this study looks for other participants.",
            "Nothing about you has been stored, and you may close this page.",
        )
    raise UnacceptableError(
        "At least one answer does not fit the instructions.",
        "Please read them again: you have one more try.",
    )


def _screen_out(session: Session, study: Study, study_session: StudySession) -> None:
    """Erase a study session, and let nobody come back under the name by which they were sent."""
    name = study_session.recruiter_participant
    if name is None and study.recruitment.names_participants:
        name = study_session.visit
    screen_out(session, name, "comprehension", study_session.last_active_at)
    study_session.place = None
    session.flush()
    session.delete(study_session)
