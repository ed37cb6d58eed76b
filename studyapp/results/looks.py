"""Looks at results: the log of looks, and interim results for researchers' pages."""

import os
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, Literal

from sqlalchemy.exc import SQLAlchemyError

from analysis.results.headline import agreed_so_far, headline_numbers
from analysis.results.report import plain
from analysis.stats.multiple_testing import NOT_LOGGED, Look, LooksBefore, looks_before
from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database, database_url_of
from studyapp.desk.jobs import RESEARCHER
from studyapp.monitoring.overview import over_because, places_so_far
from studyapp.researchers.audit import StudyState, log_look
from studyapp.researchers.interim_figures import Document
from studyapp.results.analysed_tasks import AnalysedTask, analysed_tasks
from studyapp.results.answers import has_current_design, missing_answers, read_answers
from studyapp.results.stored_answers import Answers, StoredAnswers
from studyapp.session.served_study import ServedStudy
from studyapp.side_process import give_way
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study


def earlier_looks(study: Study, answers: Answers) -> LooksBefore:
    """Return the looks at results before the reported answers.

    Looks at exactly these answers do not count, so that a report stays the same however often it
    is written.
    """
    if answers.origin != "participants" or answers.stored is None:
        return NOT_LOGGED
    state = study_state(study, answers.stored)
    rows: list[dict[Any, Any]] = answers.stored.looks.to_dict("records")
    logged = [Look(**row) for row in rows]
    return looks_before(logged, finished=state.finished, answers=state.answers)


def drop_current_looks(study: Study, stored: StoredAnswers) -> StoredAnswers:
    """Return `stored` without looks at exactly these answers, which change no report of them.

    This keeps a folder for another lab the same, however often the answers were looked at.
    """
    state, looks = study_state(study, stored), stored.looks
    current = (looks["finished"] == state.finished) & (looks["answers"] == state.answers)
    return replace(stored, looks=looks[~current].reset_index(drop=True))


def record_look(
    folder: StudyFolder,
    study: Study,
    answers: Answers,
    *,
    way: Literal["report", "export"],
    reason: str,
) -> str:
    """Log that participants' answers are about to be reported or exported.

    Parameters
    ----------
    reason : str
        The researcher's reason; may be empty.

    Returns
    -------
    str
        A warning about interim looks; empty once no more participants are expected.
    """
    shared = folder.shared_answers.exists()
    if shared or answers.origin != "participants" or answers.stored is None:
        return ""
    state = study_state(study, answers.stored)
    problem = over = ""
    try:
        database = Database.open(database_url_of(folder.root))
        with closing(database):
            with database.writing() as session:
                by = os.environ.get(RESEARCHER, "")
                log_look(session, Clock().now(), state, way=way, by=by, reason=reason)
            with suppress(InputError):  # without its videos, it is not known who takes part
                places = places_so_far(database, ServedStudy.read(folder.root), Clock().now())
                over = over_because(database, study, places)
    except (InputError, SQLAlchemyError, OSError) as error:
        problem = str(error).splitlines()[0]
    if over or not state.is_interim:
        return ""
    logged = (
        f"This look could not be logged: {problem} Mention it when you publish."
        if problem
        else "This look is logged, and later reports mention it."
    )
    source = "the report" if way == "report" else "the answers"
    have = "has" if state.finished == 1 else "have"
    return (
        f"{state.finished} of {state.planned} planned participants {have} finished. Stopping, "
        f"extending or changing the study because of {source} makes false findings more likely. "
        f"{logged}"
    )


def study_state(study: Study, stored: StoredAnswers) -> StudyState:
    """Return the state of the study."""
    sessions = stored.study_sessions
    completed = sessions["completed"].to_numpy(bool) & sessions["placed"].to_numpy(bool)
    return StudyState(
        finished=int((completed & has_current_design(sessions)).sum()),
        planned=sum(arm.places + stored.more_places for arm in study.arms),
        answers=len(stored.answers),
    )


SUMMARIES: Final[Mapping[str, Callable[[AnalysedTask], Iterable[dict[str, Any]]]]] = {
    "agreement": lambda task: agreed_so_far(task.table, task.left_out),
    "results": lambda task: headline_numbers(task.table, task.left_out.analysed),
}


def figures_so_far(folder: StudyFolder, what: str) -> Document:
    """Return figures of the answers so far.

    Parameters
    ----------
    what : {'agreement', 'results'}
        How much participants agree, which does not reveal what they prefer; or the headline
        numbers of the report.

    Raises
    ------
    InputError
        If the study cannot be read, or its answers contradict it.
    """
    study = folder.study()
    answers = read_answers(folder, "participants")
    if answers.stored is None:
        raise missing_answers(folder, "participants")
    tasks = analysed_tasks(study, answers)
    return Document(
        state=study_state(study, answers.stored),
        answered=max(task.left_out.recruited for task in tasks),
        analysed=max(task.left_out.attentive for task in tasks),
        rows=tuple(
            _row(task.protocol, number) for task in tasks for number in SUMMARIES[what](task)
        ),
    )


def _row(task: str, number: Mapping[str, Any]) -> dict[str, Any]:
    """Return a number for pages, without its p value, which assumes that there is no early look."""
    row = {name: plain(value) for name, value in number.items() if name != "p_value"}
    return row | {"task": task, "set": number["set"] or ""}


PROCESSOR_SECONDS: Final = 120


def main(arguments: Sequence[str]) -> int:
    """Print the document of ``FOLDER agreement|results``; return the exit status."""
    folder, name = arguments
    try:
        document = figures_so_far(StudyFolder(Path(folder)), name)
    except InputError as error:
        print(" ".join(str(error).split()), file=sys.stderr)
        return 1
    print(document.model_dump_json())
    return 0


if __name__ == "__main__":
    give_way(PROCESSOR_SECONDS)
    sys.exit(main(sys.argv[1:]))
