"""What participants say about themselves: checked, judged for eligibility, stored once."""

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
    """Refuse who may not take part as far as they said so before consent; nothing is stored.

    Raises
    ------
    UnacceptableError
        If an answer is missing, unknown or not one of those offered.
    IneligibleError
        If the person cannot take part.
    """
    _check_answers(study, "eligibility", fields)
    _require_eligible(study, "eligibility", fields)


def read_entrance_answers(
    study: Study, fields: Mapping[str, str], now: datetime
) -> list[FormAnswer]:
    """Return what was answered under eligibility and consent, to be stored with the enrolment.

    Raises
    ------
    UnacceptableError
        If an answer is missing, unknown or not one of those offered.
    IneligibleError
        If the person cannot take part; nothing of them is stored.
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
    """Tell whether acceptable answers to the questions of `stage` let somebody take part."""
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
        study_session = find_study_session(session, token)
        now = clock.now()
        answers = read_form_answers(study, stage, fields, now)
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
        checking = sound_check_due(study_session, served)
        if not running or checking or form_due(study_session, study) != stage:
            raise ConflictError(
                "These are not the questions you are on.",
                "The next page shows how to go on.",
            )
        study_session.form_answers.extend(answers)
        advance(session, study_session, study, now)


def read_form_answers(
    study: Study, stage: Stage, fields: Mapping[str, str], now: datetime
) -> list[FormAnswer]:
    """Return an answer for each question of `stage`; one that was left open is empty.

    Raises
    ------
    UnacceptableError
        If an answer is missing, unknown or not one of those offered.
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
    asked = enumerate(study.form.questions_at(stage), start=1)
    given = {number: (q, fields.get(q.name, "").strip()) for number, q in asked}
    problems = {number: q.problem(answer, number) for number, (q, answer) in given.items()}
    wrong = {number: problem for number, problem in problems.items() if problem is not None}
    if len(wrong) == 1:
        (problem,) = wrong.values()
        raise UnacceptableError(
            "{problem}", "The other answers you gave are kept.", problem=problem
        )
    if wrong and not any(given[number][1] for number in wrong):
        raise UnacceptableError(
            "Questions {numbers} are not answered yet.",
            "The other answers you gave are kept.",
            numbers=tuple(wrong),
        )
    if wrong:
        raise UnacceptableError(
            "Questions {numbers} have no answer yet, or one that cannot be accepted.",
            "The other answers you gave are kept.",
            numbers=tuple(wrong),
        )
