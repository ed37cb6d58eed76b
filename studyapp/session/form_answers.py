"""Participants' answers about themselves: validated, checked for eligibility, stored once.

A study may also ask questions below its instructions. Participants who answer those wrongly have a
second try, as Prolific requires; after that, everything about them is deleted except the fact of
the screen-out if the channel names everybody.

A screen-out is final for participants with a name or an invitation. The recruiter's screen-out
code is shown only once it is stored: nobody can get it, go back and change their answers.
Everybody else is only counted.
"""

from collections.abc import Mapping
from datetime import datetime
from typing import Final

from sqlalchemy import func, select, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import InstrumentedAttribute, Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.study_session import FormAnswer, ScreenOut, StudySession, StudyVersion
from studyapp.session.ending import advance
from studyapp.session.participation import sound_check_due
from studyapp.session.places import regain_place
from studyapp.session.refusal import (
    ConflictError,
    IneligibleError,
    UnacceptableError,
    UnknownAddressError,
)
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import (
    find_study_session,
    form_due,
    has_tried_comprehension,
    state_of,
    wrong_page_error,
)
from studyapp.study.settings.presentation import Message
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
        raise IneligibleError(stage)


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
            raise wrong_page_error()
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
    problems = find_problems(study, stage, fields)
    if len(problems) == 1:
        (problem,) = problems.values()
        raise UnacceptableError(
            "{problem}", "The other answers you gave are kept.", problem=problem
        )
    names = [question.name for question in study.form.questions_at(stage)]
    numbers = tuple(number for number, name in enumerate(names, start=1) if name in problems)
    if numbers:
        raise UnacceptableError(
            "Questions {numbers} have no answer yet, or one that cannot be accepted.",
            "The other answers you gave are kept.",
            numbers=numbers,
        )


def find_problems(study: Study, stage: Stage, fields: Mapping[str, str]) -> dict[str, Message]:
    """Return why answers to questions of `stage` cannot be accepted, by question."""
    problems = {
        question.name: question.problem(fields.get(question.name, "").strip(), number)
        for number, question in enumerate(study.form.questions_at(stage), start=1)
    }
    return {name: problem for name, problem in problems.items() if problem is not None}


def start_trials(
    database: Database,
    served: ServedStudy,
    token: str,
    clock: Clock,
    *,
    answers: Mapping[str, str] | None = None,
    tries: int = 0,
) -> None:
    """Start the trials; starting twice or too early changes nothing.

    Parameters
    ----------
    answers : mapping of question name to text, optional
        Answers to the comprehension questions. Those of the first try are stored.
    tries : int
        Number of tries that the page knew of. A try that is sent again, by a double click or a
        reload, counts once.

    Raises
    ------
    UnacceptableError
        If an answer is missing, which does not count as a try, or the first try is wrong.
    IneligibleError
        If the second try is wrong; the study session has been deleted.
    """
    study, answers = served.study, answers or {}
    with database.writing() as session:
        try:
            study_session = find_study_session(session, token)
        except UnknownAddressError:
            # The second try, sent again. People with names get their code by their own link alone.
            if tries and not study.recruitment.names_participants:
                raise IneligibleError("comprehension") from None
            raise
        waiting = sound_check_due(study_session, served) or form_due(study_session, study)
        if state_of(study_session) != "instructed" or waiting:
            return
        now = clock.now()
        rows = read_form_answers(study, "comprehension", answers, now)
        has_tried = has_tried_comprehension(study_session)
        is_repeated = has_tried and not tries
        if not has_tried:
            study_session.form_answers.extend(rows)
        study_session.last_active_at = now
        if not is_repeated and is_eligible(study, "comprehension", answers):
            study_session.started_at = now
            return
        is_out = has_tried and not is_repeated
        if is_out:
            _screen_out_and_delete(session, study, study_session)
    if is_out:
        raise IneligibleError("comprehension")
    raise UnacceptableError(
        "At least one answer does not fit the instructions.",
        "Please read them again: you have one more try.",
    )


def _screen_out_and_delete(session: Session, study: Study, study_session: StudySession) -> None:
    """Delete a study session, and screen out its participant, by name if the channel names all."""
    name = None
    if study.recruitment.names_participants:
        name = study_session.recruiter_participant or study_session.visit
    _screen_out(session, name, "comprehension", study_session.last_active_at)
    study_session.place = None
    session.flush()
    session.delete(study_session)


COUNTS: Final[Mapping[Stage, InstrumentedAttribute[int]]] = {
    "eligibility": StudyVersion.screened_by_eligibility,
    "consent": StudyVersion.screened_by_consent,
    "comprehension": StudyVersion.screened_by_comprehension,
}
"""The column that counts screen-outs at each stage."""


def was_screened_out(database: Database, name: str) -> bool:
    """Tell whether the person who comes by `name` was screened out before."""
    with database.reading() as session:
        return _is_stored(session, name)


def note_screen_out(database: Database, name: str | None, stage: Stage, clock: Clock) -> None:
    """Count a person as screened out at `stage`.

    Parameters
    ----------
    name : str or None
        The name to store, so that they stay screened out and are counted once.
    """
    try:
        with database.writing() as session:
            if name is None or not _is_stored(session, name):
                _screen_out(session, name, stage, clock.now())
    except IntegrityError:
        pass  # the same person in another window, at the same moment


def _screen_out(session: Session, name: str | None, stage: Stage, now: datetime) -> None:
    """Count a screen-out, and store the person's name if there is one."""
    if name is not None:
        session.add(ScreenOut(participant=name, screened_out_at=now))
        session.flush()
    count = COUNTS[stage]
    session.execute(
        update(StudyVersion).where(StudyVersion.in_force).values({count: count + 1}),
        execution_options={"synchronize_session": False},
    )


def count_screened_out(session: Session) -> dict[str, int]:
    """Count the screen-outs at each stage, in all versions of the study."""
    sums = [func.coalesce(func.sum(count), 0) for count in COUNTS.values()]
    return dict(zip(COUNTS, map(int, session.execute(select(*sums)).one()), strict=True))


def _is_stored(session: Session, name: str) -> bool:
    return session.scalar(select(ScreenOut.id).where(ScreenOut.participant == name)) is not None
