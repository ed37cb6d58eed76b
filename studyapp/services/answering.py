"""Answering a trial: all its questions at once, stored before anything else happens."""

from __future__ import annotations

import re
import secrets
from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Final

from motion.listing import listed
from studyapp.clock import Clock
from studyapp.definition.study import Study
from studyapp.models import Response, StudySession, Trial
from studyapp.services.database import Database
from studyapp.services.places import regain_place
from studyapp.services.refusal import ConflictError, UnacceptableError
from studyapp.services.sitting import current_trial, find, require_present, trial_of
from studyapp.services.watching import watched_so_far

CODE_LETTERS: Final = "ABCDEFGHJKMNPQRTUVWXYZ2346789"
"""Letters and digits that are not taken for one another."""

CODE_LENGTH: Final = 12


def answer(
    database: Database,
    study: Study,
    token: str,
    media_token: str,
    answers: Mapping[str, str],
    clock: Clock,
) -> None:
    """Store the answers of the present trial; with the last one comes the completion code.

    The same answers sent again change nothing and are no error.

    Parameters
    ----------
    media_token : str
        The trial that was answered.
    answers : mapping of question name to text
        As the form sent them; one for every question of the study, ``"-2"`` to ``"2"``.

    Raises
    ------
    RefusalError
        If the trial is not theirs, not the present one or answered differently before, an
        answer is missing, unknown or out of range, or the video is not yet watched. Nothing is
        changed then.
    """
    with database.writing() as session:
        study_session = find(session, token)
        trial = trial_of(study_session, media_token)
        values = _values([question.name for question in study.questions], answers)
        if trial.answered_at is not None:
            _require_same(trial, values)
            return
        regain_place(session, study, study_session)
        shown_at = require_present(study_session, trial)
        missing = watched_so_far(trial, study.watching.coverage).missing
        if missing > 0:
            raise UnacceptableError(
                f"About {max(1, round(missing))} s of the videos have not been played yet.",
                "Please play them to the end; your answers below are kept.",
            )
        now = clock.now()
        trial.responses = [
            Response(question=question, value=value, answered_at=now)
            for question, value in values.items()
        ]
        trial.answered_at = now
        trial.seconds = clock.seconds_since(shown_at)
        _move_on(study_session, now)


def skip_unplayable(
    database: Database, study: Study, token: str, media_token: str, clock: Clock
) -> None:
    """Record that the video of the present trial does not play, and go on without an answer.

    Raises
    ------
    RefusalError
        If the trial is not theirs or not the present one.
    """
    with database.writing() as session:
        study_session = find(session, token)
        trial = trial_of(study_session, media_token)
        if trial.unplayable_at is not None:
            return
        regain_place(session, study, study_session)
        require_present(study_session, trial)
        now = clock.now()
        trial.unplayable_at = now
        _move_on(study_session, now)


def _values(questions: Sequence[str], answers: Mapping[str, str]) -> dict[str, int]:
    """Return the answers as numbers, one per question."""
    unknown = sorted(set(answers) - set(questions))
    if unknown:
        raise UnacceptableError(
            "The form held an answer to a question that this study does not ask.",
            "Please reload the page and answer the questions shown.",
        )
    for question in questions:
        if question in answers and not re.fullmatch(r"-?[12]|0", answers[question]):
            raise UnacceptableError(
                "An answer is not one of the five choices.",
                "Please choose one of the five for every question.",
            )
    missing = [str(at) for at, name in enumerate(questions, start=1) if name not in answers]
    if missing:
        who = (
            f"Question {missing[0]} is" if len(missing) == 1 else f"Questions {listed(missing)} are"
        )
        raise UnacceptableError(
            f"{who} not answered yet.",
            "Please choose one of the five answers; the others you gave are kept.",
        )
    return {question: int(answers[question]) for question in questions}


def _require_same(trial: Trial, values: Mapping[str, int]) -> None:
    stored = {response.question: response.value for response in trial.responses}
    if stored != values:
        raise ConflictError(
            "You have already answered this pair, and your first answer is stored.",
            "An answer cannot be changed once it is sent. Please go on with the next pair.",
        )


def _move_on(study_session: StudySession, now: datetime) -> None:
    """Note the activity; after the last trial, complete the study session."""
    study_session.last_active_at = now
    if current_trial(study_session) is None:
        study_session.completed_at = now
        study_session.completion_code = "".join(
            secrets.choice(CODE_LETTERS) for _ in range(CODE_LENGTH)
        )
