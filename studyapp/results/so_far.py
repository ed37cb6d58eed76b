"""Agreement and results of the answers so far, as researchers' pages show them."""

from __future__ import annotations

import os
import resource
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from pydantic import BaseModel

from analysis.results.headline import AgreedSoFar, HeadlineNumber, agreed_so_far, headline_numbers
from analysis.results.plain import rounded
from motion.errors import InputError
from studyapp.researchers.interim.documents import (
    Agreed,
    AgreementDocument,
    Basis,
    Estimated,
    Number,
    ResultsDocument,
)
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


def agreement_so_far(folder: StudyFolder) -> AgreementDocument:
    """Return how far participants agree; it does not tell what they prefer.

    Raises
    ------
    InputError
        If the study cannot be read, or its answers contradict it.
    """
    basis, tasks = _analysed(folder)
    return AgreementDocument(
        basis=basis,
        rows=tuple(
            _agreed(task.protocol, one)
            for task in tasks
            for one in agreed_so_far(task.table, task.left_out)
        ),
    )


def results_so_far(folder: StudyFolder) -> ResultsDocument:
    """Return the headline numbers of the report, as far as there are answers.

    Raises
    ------
    InputError
        If the study cannot be read, or its answers contradict it.
    """
    basis, tasks = _analysed(folder)
    return ResultsDocument(
        basis=basis,
        rows=tuple(
            _estimated(task.protocol, one)
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


def _agreed(task: str, one: AgreedSoFar) -> Agreed:
    retest = one.retest
    return Agreed(
        task=task,
        set=one.set or "",
        question=one.question,
        measure=one.measure,
        agreement=_number(one.estimate, one.low, one.high, one.reason),
        answers=one.n,
        participants=one.participants,
        retest=None
        if retest is None or not retest.n
        else _number(retest.kappa, retest.low, retest.high, retest.reason),
        repeated=0 if retest is None else retest.n,
    )


def _estimated(task: str, one: HeadlineNumber) -> Estimated:
    return Estimated(
        task=task,
        set=one.set or "",
        question=one.question,
        about=one.a,
        against=one.b,
        measure=one.measure,
        number=_number(one.estimate, one.low, one.high, one.reason),
        answers=one.n,
        participants=one.participants,
        segments=one.segments,
    )


def _number(estimate: float, low: float, high: float, reason: str) -> Number:
    return Number(estimate=rounded(estimate), low=rounded(low), high=rounded(high), reason=reason)


DOCUMENTS: Final[dict[str, Callable[[StudyFolder], BaseModel]]] = {
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
