"""Participants' answers about themselves: validated, checked for eligibility, stored once."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Final

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import FormAnswer
from studyapp.session.ending import advance
from studyapp.session.participation import sound_check_due
from studyapp.session.places import regain_place
from studyapp.session.refusal import ConflictError, IneligibleError, UnacceptableError
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import find_study_session, form_due
from studyapp.study.settings.questions import Stage
from studyapp.study.settings.study import Study

BEFORE_ENROLMENT: Final[tuple[Stage, ...]] = ("eligibility", "consent")


def check_eligibility(study: Study, fields: Mapping[str, str]) -> None:
    """Check the answers to the questions of eligibility; nothing is stored.

    Raises
    ------
    UnacceptableError
        If an answer is missing or invalid.
    IneligibleError
        If the person cannot take part.
    """
    _check_answers(study, "eligibility", fields)
    _require_eligible(study, "eligibility", fields)


def read_entrance_answers(
    study: Study, fields: Mapping[str, str], now: datetime
) -> list[FormAnswer]:
    """Return the answers to the questions of eligibility and consent, as rows to be stored.

    Raises
    ------
    UnacceptableError
        If an answer is missing or invalid.
    IneligibleError
        If the person cannot take part.
    """
    answers = []
    for stage in BEFORE_ENROLMENT:
        answers.extend(read_form_answers(study, stage, fields, now))
        _require_eligible(study, stage, fields)
    return answers


def _require_eligible(study: Study, stage: Stage, fields: Mapping[str, str]) -> None:
    if not is_eligible(study, stage, fields):
        raise IneligibleError(
            "Thank you for your interest: this study looks for other participants.",
            "Nothing about you has been stored, and you may close this page.",
        )


def ineligible_stage(study: Study, fields: Mapping[str, str]) -> Stage:
    """Return the stage before enrolment at which somebody ineligible said so."""
    return next(stage for stage in BEFORE_ENROLMENT if not is_eligible(study, stage, fields))


def is_eligible(study: Study, stage: Stage, fields: Mapping[str, str]) -> bool:
    """Tell whether valid answers to the questions of `stage` let somebody take part."""
    return all(
        not question.eligible or fields[question.name].strip() in question.eligible
        for question in study.form.questions_at(stage)
    )


def store_form_answers(
    database: Database,
    served: ServedStudy,
    token: str,
    stage: Stage,
    fields: Mapping[str, str],
    clock: Clock,
) -> None:
    """Store the answers of one stage; sending the same answers again changes nothing.

    Parameters
    ----------
    stage : {'demographics', 'closing'}
    fields : mapping of question name to text
        The form as sent; optional questions may be missing.

    Raises
    ------
    RefusalError
        If the stage is not due, an answer is invalid, or other answers are already stored.
    """
    study = served.study
    with database.writing() as session:
        study_session = find_study_session(session, token)
        now = clock.now()
        answers = read_form_answers(study, stage, fields, now)
        stored = {
            answer.question: answer.value
            for answer in study_session.form_answers
            if answer.stage == stage
        }
        if stored:
            if stored != {answer.question: answer.value for answer in answers}:
                raise ConflictError(
                    "You have already answered these questions, and your answers are stored.",
                    "Please go on; nothing you answered is lost.",
                )
            return
        regain_place(session, served, study_session)
        is_running = study_session.place is not None and study_session.completed_at is None
        is_checking = sound_check_due(study_session, served)
        if not is_running or is_checking or form_due(study_session, study) != stage:
            raise ConflictError(
                "These are not the questions you are on.",
                "The next page shows how to go on.",
            )
        study_session.form_answers.extend(answers)
        advance(session, study_session, study, now)


def read_form_answers(
    study: Study, stage: Stage, fields: Mapping[str, str], now: datetime
) -> list[FormAnswer]:
    """Return a row for each question of `stage`; missing optional answers are empty.

    Raises
    ------
    UnacceptableError
        If an answer is missing or invalid.
    """
    _check_answers(study, stage, fields)
    return [
        FormAnswer(
            stage=stage,
            question=question.name,
            value=fields.get(question.name, "").strip(),
            answered_at=now,
        )
        for question in study.form.questions_at(stage)
    ]


def _check_answers(study: Study, stage: Stage, fields: Mapping[str, str]) -> None:
    questions = dict(enumerate(study.form.questions_at(stage), start=1))
    answers = {number: fields.get(q.name, "").strip() for number, q in questions.items()}
    problems = {number: q.problem(answers[number], number) for number, q in questions.items()}
    invalid = {number: problem for number, problem in problems.items() if problem is not None}
    if len(invalid) == 1:
        (problem,) = invalid.values()
        raise UnacceptableError(
            "{problem}", "The other answers you gave are kept.", problem=problem
        )
    if invalid and not any(answers[number] for number in invalid):
        raise UnacceptableError(
            "Questions {numbers} are not answered yet.",
            "The other answers you gave are kept.",
            numbers=tuple(invalid),
        )
    if invalid:
        raise UnacceptableError(
            "Questions {numbers} have no answer yet, or one that cannot be accepted.",
            "The other answers you gave are kept.",
            numbers=tuple(invalid),
        )
