"""Looks at results: that reports and exports are some, and which there were before."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from typing import Any, Literal

from sqlalchemy.exc import SQLAlchemyError

from analysis.results.looks import NOT_LOGGED, Look, LooksBefore, looks_before
from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database, database_url_of
from studyapp.researchers.looks import note_look
from studyapp.results.so_far import study_state
from studyapp.results.stored_answers import Answers, StoredAnswers
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study


def earlier_looks(study: Study, answers: Answers) -> LooksBefore:
    """Return the looks at results before the answers that are reported.

    Those at these very answers are left out: a report is no look before itself, so that it is the
    same however often it is written, and by whom.
    """
    if answers.origin != "participants" or answers.stored is None:
        return NOT_LOGGED
    state = study_state(study, answers.stored)
    rows: list[dict[Any, Any]] = answers.stored.looks.to_dict("records")
    logged = [Look(**row) for row in rows]
    return looks_before(logged, finished=state.finished, answers=state.answers)


def with_looks_before(study: Study, stored: StoredAnswers) -> StoredAnswers:
    """Return `stored` without the looks at these very answers, which change no report of them.

    So a folder for another lab is the same bytes however often the answers were looked at.
    """
    state, looks = study_state(study, stored), stored.looks
    present = (looks["finished"] == state.finished) & (looks["answers"] == state.answers)
    return replace(stored, looks=looks[~present].reset_index(drop=True))


def note_way_out(
    folder: StudyFolder,
    study: Study,
    answers: Answers,
    *,
    way: Literal["report", "export"],
    reason: str,
) -> str:
    """Log that answers of participants are reported or exported, before they are.

    Parameters
    ----------
    reason : str
        Why, where it was said.

    Returns
    -------
    str
        What whoever does it must know, in sentences; empty where everybody has finished.
    """
    shared = folder.shared_answers.is_dir()
    if shared or answers.origin != "participants" or answers.stored is None:
        return ""
    state = study_state(study, answers.stored)
    problem = ""
    try:
        database = Database.open(database_url_of(folder.root))
        with closing(database), database.writing() as session:
            note_look(session, Clock().now(), state, way=way, reason=reason)
    except (InputError, SQLAlchemyError, OSError) as error:
        problem = str(error).splitlines()[0]
    if not state.is_interim:
        return ""
    logged = (
        f"It could not be logged that you looked: {problem} Say so where you publish."
        if problem
        else "That you looked is logged, and later reports say so."
    )
    seen = "the report shows" if way == "report" else "the answers show"
    return (
        f"{state.finished} of {state.planned} planned participants have finished. To stop, extend "
        f"or change the study because of what {seen} makes false findings likelier. "
        f"{logged}"
    )
