"""From the instructions to the trials, with comprehension questions.

A study may ask questions below its instructions. Participants who answer wrongly have a second try,
as Prolific requires. After that they are screened out, and everything about them is deleted except
the fact of the screen-out if a recruiter named them.
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
    """Start the trials; starting twice or too early changes nothing.

    Parameters
    ----------
    answers : mapping of question name to text, optional
        Answers to the comprehension questions. Those of the first try are stored.

    Raises
    ------
    UnacceptableError
        If an answer is missing, which does not count as a try, or the first try is wrong.
    IneligibleError
        If the second try is wrong; the study session has been deleted.
    """
    study, answers = served.study, answers or {}
    with database.writing() as session:
        study_session = find_study_session(session, token)
        waiting = sound_check_due(study_session, served) or form_due(study_session, study)
        if state_of(study_session) != "instructed" or waiting:
            return
        now = clock.now()
        rows = read_form_answers(study, "comprehension", answers, now)
        has_tried = any(answer.stage == "comprehension" for answer in study_session.form_answers)
        if not has_tried:
            study_session.form_answers.extend(rows)
        study_session.last_active_at = now
        if is_eligible(study, "comprehension", answers):
            study_session.started_at = now
            return
        if has_tried:
            _screen_out(session, study, study_session)
    if has_tried:
        raise IneligibleError(
            "Thank you for your interest: this study looks for other participants.",
            "Nothing about you has been stored, and you may close this page.",
        )
    raise UnacceptableError(
        "At least one answer does not fit the instructions.",
        "Please read them again: you have one more try.",
    )


def _screen_out(session: Session, study: Study, study_session: StudySession) -> None:
    """Delete a study session, and screen out the name under which its participant was sent."""
    name = study_session.recruiter_participant
    if name is None and study.recruitment.names_participants:
        name = study_session.visit
    screen_out(session, name, "comprehension", study_session.last_active_at)
    study_session.place = None
    session.flush()
    session.delete(study_session)
