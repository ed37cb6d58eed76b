"""The tasks of a study with their answers and exclusions."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import pandas as pd

from analysis.answers.cells import Cells
from analysis.answers.participants import LeftOut, leave_out
from analysis.answers.reading import Order, answers_in
from analysis.answers.table import LAYOUTS, AnswerTable
from studyapp.results.answer_table import empty_answers, study_answers
from studyapp.results.answers import has_current_design
from studyapp.results.stated_beforehand import StudyExclusions, study_exclusions
from studyapp.results.stored_answers import Answers
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.study import Study

ANSWERS: Final = "answers.csv"
"""The table of a study's answers, as reports write it under ``tables``: in the columns that any
platform's table may have."""


@dataclass(frozen=True, kw_only=True, eq=False)
class AnalysedTask:
    """One task of a study.

    Attributes
    ----------
    protocol : str
        The protocol of its analysis.
    rows : DataFrame
        Its answers as text, in the columns of ``docs/report-contract.md``.
    table : AnswerTable
        The same, validated.
    left_out : LeftOut
        The excluded participants.
    """

    protocol: str
    rows: pd.DataFrame
    table: AnswerTable
    left_out: LeftOut


def exclusions_of(study: Study, answers: Answers) -> StudyExclusions:
    """Return the exclusion rules of `study`, and the exclusions by hand.

    The latter, and rules that were added after the first participant arrived, are exploratory.
    """
    before = answers.stated if answers.origin == "participants" else None
    return study_exclusions(
        study.settled_exclusions,
        None if before is None else before.settled_exclusions,
        None if answers.stored is None else answers.stored.study_sessions,
    )


def analysed_tasks(study: Study, answers: Answers) -> list[AnalysedTask]:
    """Return the tasks of `study`, the task of its protocol first.

    Raises
    ------
    InputError
        If the answers contradict the study.
    """
    rules, stored = exclusions_of(study, answers), answers.stored
    answered = (
        empty_answers(study)
        if stored is None
        else study_answers(study, stored.part(has_current_design(stored.study_sessions)))
    )
    tasks = []
    for protocol, rows in answered.tables.items():
        table = answers_in(
            Cells(path=Path(ANSWERS), rows=rows, numbers=pd.RangeIndex(len(rows)) + 2, ignored=()),
            LAYOUTS[protocol],
            Order(
                conditions=compared_conditions(study),
                questions=tuple(question.name for question in study.questions),
                sets=study.parts,
                scales=_scales(study),
            ),
        )
        left_out = leave_out(table, rules.rules, planned=rules.planned, known=answered.known)
        tasks.append(AnalysedTask(protocol=protocol, rows=rows, table=table, left_out=left_out))
    return tasks


def _scales(study: Study) -> dict[str, tuple[int, int]]:
    """Return the lowest and highest rating of each question; empty without ratings."""
    if not isinstance(study, RatingStudy):
        return {}
    return {
        question.name: (min(question.values), max(question.values)) for question in study.questions
    }


def compared_conditions(study: Study) -> tuple[str, ...]:
    """Return the compared conditions in the order of the study file."""
    if isinstance(study, RankingStudy):
        return tuple(name for name in study.conditions if name != study.reference)
    return tuple(study.conditions)


def study_notes(study: Study) -> tuple[str, ...]:
    """Return what a report and a check note about the study's design."""
    if study.has_recording or not study.catch.trials:
        return ()
    names = study.display_names
    return (
        "No condition is a recording of a person, so there is no ground truth: "
        f"catch trials show {names[study.catch_against]} against {names[study.catch.condition]}.",
    )
