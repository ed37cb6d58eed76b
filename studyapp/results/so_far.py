"""Agreement and results of the answers so far, as researchers' pages show them."""

from __future__ import annotations

import os
import resource
import sys
from collections.abc import Callable, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, Final

from analysis.results.headline import AgreedSoFar, HeadlineNumber, agreed_so_far, headline_numbers
from analysis.results.report import plain
from motion.errors import InputError
from studyapp.researchers.interim.documents import Basis, Document
from studyapp.researchers.looks import StudyState
from studyapp.results.analysed_tasks import AnalysedTask, analysed_tasks, rules_of
from studyapp.results.answers import read_answers
from studyapp.results.report_arms import of_present_design
from studyapp.results.stored_answers import StoredAnswers
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study


def study_state(study: Study, stored: StoredAnswers) -> StudyState:
    """Return how far the study is."""
    sessions = stored.study_sessions
    done = sessions["completed"].to_numpy(bool) & sessions["placed"].to_numpy(bool)
    return StudyState(
        finished=int((done & of_present_design(sessions)).sum()),
        planned=sum(arm.places + stored.more_places for arm in study.arms),
        answers=len(stored.answers),
    )


def agreement_so_far(folder: StudyFolder) -> Document:
    """Return how far participants agree; it does not tell what they prefer.

    Raises
    ------
    InputError
        If the study cannot be read, or its answers contradict it.
    """
    basis, tasks = _analysed(folder)
    return Document(
        basis=basis,
        rows=tuple(
            _row(task.protocol, one)
            for task in tasks
            for one in agreed_so_far(task.table, task.left_out)
        ),
    )


def results_so_far(folder: StudyFolder) -> Document:
    """Return the headline numbers of the report, as far as there are answers.

    Raises
    ------
    InputError
        If the study cannot be read, or its answers contradict it.
    """
    basis, tasks = _analysed(folder)
    return Document(
        basis=basis,
        rows=tuple(
            _row(task.protocol, one)
            for task in tasks
            for one in headline_numbers(task.table, task.left_out.analysed)
        ),
    )


def _analysed(folder: StudyFolder) -> tuple[Basis, Sequence[AnalysedTask]]:
    study = folder.study()
    answers = read_answers(folder, "participants")
    if answers.stored is None or answers.origin == "none":
        planned = sum(arm.places for arm in study.arms)
        return Basis(finished=0, planned=planned, answers=0, answered=0, analysed=0), ()
    tasks = analysed_tasks(study, answers, rules_of(study, answers))
    state = study_state(study, answers.stored)
    basis = Basis(
        finished=state.finished,
        planned=state.planned,
        answers=state.answers,
        answered=max(task.left_out.recruited for task in tasks),
        analysed=max(task.left_out.attentive for task in tasks),
    )
    return basis, tasks


def _row(task: str, found: AgreedSoFar | HeadlineNumber) -> dict[str, Any]:
    """Return what is shown of a number; no p, which would assume that nobody looks before."""
    names = [each.name for each in fields(found) if each.name != "p_value"]
    row = {name: plain(getattr(found, name)) for name in names}
    return row | {"task": task, "set": found.set or ""}


DOCUMENTS: Final[dict[str, Callable[[StudyFolder], Document]]] = {
    "agreement": agreement_so_far,
    "results": results_so_far,
}
PROCESSOR_SECONDS: Final = 120
LESS_URGENT: Final = 10
"""Than the server that participants wait for."""


def main(arguments: Sequence[str]) -> int:
    """Print the document that ``FOLDER agreement|results`` asks for; return the exit status."""
    folder, what = arguments
    try:
        document = DOCUMENTS[what](StudyFolder(Path(folder)))
    except InputError as error:
        print(" ".join(str(error).split()), file=sys.stderr)
        return 1
    print(document.model_dump_json())
    return 0


if __name__ == "__main__":
    os.nice(LESS_URGENT)
    resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_SECONDS, PROCESSOR_SECONDS))
    sys.exit(main(sys.argv[1:]))
