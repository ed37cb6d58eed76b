"""What participants say about themselves: checked, judged for eligibility, stored once."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Final

from studyapp.clock import Clock
from studyapp.definition.form import Stage
from studyapp.definition.study import Study
from studyapp.models import FormAnswer
from studyapp.services.database import Database
from studyapp.services.finishing import move_on
from studyapp.services.places import regain_place
from studyapp.services.refusal import ConflictError, IneligibleError, UnacceptableError
from studyapp.services.served_study import ServedStudy
from studyapp.services.sitting import find, form_due

BEFORE_ENROLMENT: Final[tuple[Stage, ...]] = ("eligibility", "consent")


def entrance_answers(study: Study, fields: Mapping[str, str], now: datetime) -> list[FormAnswer]:
    """Return what was answered under eligibility and consent, to be stored with the enrolment.

    Raises
    ------
    UnacceptableError
        If an answer is missing, unknown or not one of those offered.
    IneligibleError
        If the person cannot take part; nothing of them is stored.
    """
    answers = [
        answer for stage in BEFORE_ENROLMENT for answer in _answers(study, stage, fields, now)
    ]
    given = {answer.question: answer.value for answer in answers}
    for stage in BEFORE_ENROLMENT:
        for question in study.form.asked(stage):
            if question.eligible and given[question.name] not in question.eligible:
                raise IneligibleError(
                    "Thank you for your interest: this study looks for other participants.",
                    "Nothing about you has been stored, and you may close this page.",
                )
    return answers


def answer_form(
    database: Database,
    served: ServedStudy,
    token: str,
    stage: Stage,
    fields: Mapping[str, str],
    clock: Clock,
) -> None:
    """Store the answers of one stage; the same answers sent again change nothing.

    Parameters
    ----------
    stage : {'demographics', 'closing'}
        Which questions are answered.
    fields : mapping of question name to text
        As the form sent them; a question that may be left open may be missing.

    Raises
    ------
    RefusalError
        If it is not the stage the participant is at, an answer cannot be accepted, or other
        answers were given before.
    """
    study = served.study
    with database.writing() as session:
        study_session = find(session, token)
        now = clock.now()
        answers = _answers(study, stage, fields, now)
        stored = {
            known.question: known.value
            for known in study_session.form_answers
            if known.stage == stage
        }
        if stored:
            if stored != {answer.question: answer.value for answer in answers}:
                raise ConflictError(
                    "You have already answered these questions, and your answers are stored.",
                    "Please go on; nothing you answered is lost.",
                )
            return
        regain_place(session, served, study_session)
        running = study_session.place is not None and study_session.completed_at is None
        if not running or form_due(study_session, study) != stage:
            raise ConflictError(
                "These questions are not the ones you are at.",
                "The page you come to next shows how to go on.",
            )
        study_session.form_answers.extend(answers)
        move_on(study_session, study, now)


def _answers(
    study: Study, stage: Stage, fields: Mapping[str, str], now: datetime
) -> list[FormAnswer]:
    """Return an answer for each question of `stage`; one that was left open is empty."""
    answers = []
    for number, question in enumerate(study.form.asked(stage), start=1):
        value = fields.get(question.name, "").strip()
        problem = question.problem(value, number)
        if problem is not None:
            raise UnacceptableError(
                "{problem}", "The other answers you gave are kept.", problem=problem
            )
        answers.append(
            FormAnswer(stage=stage, question=question.name, value=value, answered_at=now)
        )
    return answers
