"""The tasks of a study with their answers and exclusions.

Stored answers are put into the columns of ``docs/report-contract.md``: a study is analysed like a
table from any platform, and the table in its report reproduces the results.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd

from analysis.answers.cells import Cells
from analysis.answers.exclusion_rules import KnownFacts
from analysis.answers.participants import LeftOut, leave_out
from analysis.answers.reading import Order, answers_in
from analysis.answers.table import LAYOUTS, AnswerTable
from studyapp.results.answers import has_current_design
from studyapp.results.stated_beforehand import exclusions_of
from studyapp.results.stored_answers import Answers, StoredAnswers
from studyapp.session.ending import JudgedTrial
from studyapp.study.design.trial import AnswerKey
from studyapp.study.protocols.mismatch import FIT, REALISM
from studyapp.study.protocols.ranking import RankingStudy
from studyapp.study.protocols.rating import RatingStudy
from studyapp.study.settings.questions import SCALE_STEPS
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


def analysed_tasks(study: Study, answers: Answers) -> list[AnalysedTask]:
    """Return the tasks of `study`, the task of its protocol first.

    Raises
    ------
    InputError
        If the answers contradict the study.
    """
    rules, stored = exclusions_of(study, answers), answers.stored
    tables, known = (
        (_empty_tables(study), {})
        if stored is None
        else study_answers(study, stored.part(has_current_design(stored.study_sessions)))
    )
    tasks = []
    for protocol, rows in tables.items():
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
        left_out = leave_out(table, rules.rules, planned=rules.planned, known=known)
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


SHARED: Final = (
    *("participant", "segment", "question", "trial", "kind", "set", "emotion", "speaker"),
    *("response_seconds", "watched", "instructed"),
)
"""Columns of all protocols."""

OWN: Final[Mapping[str, tuple[str, ...]]] = {
    "pairwise": ("left", "right", "response", "correct_side"),
    "rating": ("condition", "response"),
    "ranking": ("condition", "rank"),
    "mismatch": ("condition", "left_speech", "right_speech", "response", "correct_side"),
}
"""Further columns of each protocol."""

PARTS_OF: Final[Mapping[str, str]] = {"mismatch": FIT, "pairwise": REALISM}
"""The part of a mismatch study that each of its two tasks analyses."""

KNOWN_COLUMNS: Final = (
    *("study_session", "trials", "settled", "left_out_catch", "left_out_attention"),
    *("excluded_because", "excluded_after_look"),
)

AFTER_LOOK: Final = " (decided after results had been looked at)"
"""Appended to a researcher's reason for an exclusion."""

MIDDLE: Final = 3
"""The value of 'no difference' in a table; it is stored as 0."""


def study_answers(
    study: Study, stored: StoredAnswers
) -> tuple[dict[str, pd.DataFrame], dict[str, KnownFacts]]:
    """Return stored answers, of the reported study sessions, in the report's columns.

    Returns
    -------
    tables : dict of str to DataFrame
        By protocol; a mismatch study can have two. All cells are text.
    known : dict of participant to KnownFacts
        Facts that the tables do not contain.
    """
    return _tables(study, stored), _known_facts(study, stored)


def _empty_tables(study: Study) -> dict[str, pd.DataFrame]:
    """Return tables without rows, for a report before there are answers."""
    protocols = [study.protocol]
    if study.protocol == "mismatch":
        protocols = [protocol for protocol, part in PARTS_OF.items() if part in study.parts]
    return {
        protocol: pd.DataFrame(columns=[*SHARED, *OWN[protocol]], dtype=str)
        for protocol in protocols
    }


def _tables(study: Study, stored: StoredAnswers) -> dict[str, pd.DataFrame]:
    rows = stored.answers.merge(stored.trials, on="trial", validate="many_to_one")
    if study.protocol in ("rating", "ranking"):
        single = stored.stimuli.rename(columns={"number": "stimulus"})[
            ["trial", "stimulus", "condition"]
        ]
        rows = rows.merge(single, on=["trial", "stimulus"], validate="many_to_one")
        judged = _each_stimulus(study, rows)
        return {study.protocol: _table(study.protocol, judged, has_sets=len(study.parts) > 1)}
    rows = rows.merge(sides(stored.stimuli), on="trial", validate="many_to_one")
    if study.protocol == "pairwise":
        return {"pairwise": _table("pairwise", _pairs(rows))}
    tables = {}
    if FIT in study.parts:
        tables["mismatch"] = _table("mismatch", _speeches(rows[rows["part"] == FIT]))
    if REALISM in study.parts:
        realism = rows[rows["part"] == REALISM].assign(part="")
        tables["pairwise"] = _table("pairwise", _pairs(realism))
    return tables


def _table(protocol: str, rows: pd.DataFrame, *, has_sets: bool = False) -> pd.DataFrame:
    """Return the columns of a protocol's table, with all cells as text.

    A study with several sets names them even if only one has answers yet.
    """
    named = rows.drop(columns="trial").rename(
        columns={
            "study_session": "participant",
            "position": "trial",
            "seconds": "response_seconds",
            "part": "set",
        }
    )
    names = [*SHARED, *OWN[protocol]]
    if not has_sets:
        names.remove("set")
    return pd.DataFrame({name: _text(named[name]) for name in names}, dtype=str).reset_index(
        drop=True
    )


def _text(column: pd.Series[Any]) -> pd.Series[str]:
    """Return cells as text; missing values are empty, whole numbers have no point."""
    codes, values = pd.factorize(column)
    words = [f"{value:.10g}" if isinstance(value, float) else str(value) for value in values]
    return pd.Series(np.array([*words, ""], dtype=object)[codes], dtype=str)


def sides(stimuli: pd.DataFrame) -> pd.DataFrame:
    """Return the left and right stimulus of each trial with a pair."""
    columns = ["trial", "condition", "segment", "speech"]
    stimuli = stimuli[stimuli.groupby("trial")["number"].transform("size") == 2]
    left, right = (stimuli.loc[stimuli["number"] == number, columns] for number in (1, 2))
    return left.merge(right, on="trial", suffixes=("_left", "_right"))


def _answered_sides(rows: pd.DataFrame) -> pd.DataFrame:
    return rows.assign(
        response=rows["value"] + MIDDLE,
        instructed=rows["instructed"] + MIDDLE,
        correct_side=rows["expected"].map({1.0: "left", 2.0: "right"}),
    )


def _pairs(rows: pd.DataFrame) -> pd.DataFrame:
    return _answered_sides(rows).rename(
        columns={"condition_left": "left", "condition_right": "right"}
    )


def _speeches(rows: pd.DataFrame) -> pd.DataFrame:
    return _answered_sides(rows).assign(
        condition=rows["condition_left"],
        left_speech=np.where(rows["speech_left"] == rows["segment_left"], "own", "other"),
        right_speech=np.where(rows["speech_right"] == rows["segment_right"], "own", "other"),
    )


def _each_stimulus(study: Study, rows: pd.DataFrame) -> pd.DataFrame:
    """Return ratings and ranks, without catch trials, which have no correct side here."""
    rows = rows[rows["kind"] != "catch"]
    if isinstance(study, RatingStudy):
        # An attention check asks for a label; a slider has more values.
        labels = [q.name for q in study.questions if len(q.values) == SCALE_STEPS]
        instructed = rows["instructed"].where(rows["question"].isin(labels))
        return rows.assign(response=rows["value"], instructed=instructed)
    first = rows["instructed"] == rows["stimulus"]
    return rows.assign(rank=rows["value"], instructed=np.where(first, 1.0, np.nan))


def _known_facts(study: Study, stored: StoredAnswers) -> dict[str, KnownFacts]:
    failed = _failures(study, stored)
    sessions = stored.study_sessions
    return {
        str(session): KnownFacts(
            trials=int(trials),
            settled=int(settled),
            failed_catch=failed[session, "catch"] + int(no_catch) if study.catch.trials else None,
            failed_attention=failed[session, "attention"] + int(no_attention)
            if study.attention.trials
            else None,
            decided=f"{reason}{AFTER_LOOK}" if reason and after_look else str(reason),
        )
        for session, trials, settled, no_catch, no_attention, reason, after_look in zip(
            *(sessions[name].tolist() for name in KNOWN_COLUMNS),
            strict=True,
        )
    }


def _failures(study: Study, stored: StoredAnswers) -> Counter[tuple[int, str]]:
    """Return how many catch trials and attention checks each study session failed."""
    judged = stored.trials[stored.trials["kind"].isin(["catch", "attention"])]
    answers: defaultdict[Any, dict[AnswerKey, int]] = defaultdict(dict)
    given = stored.answers[stored.answers["trial"].isin(judged["trial"])]
    for trial_id, question, number, value in zip(
        *(given[name] for name in ("trial", "question", "stimulus", "value")), strict=True
    ):
        answers[trial_id][question, number or None] = value
    shown = stored.stimuli[stored.stimuli["trial"].isin(judged["trial"])]
    conditions: dict[Any, tuple[str, ...]] = (
        shown.groupby("trial")["condition"].agg(tuple).to_dict()
    )
    failed: Counter[tuple[int, str]] = Counter()
    for row in judged.itertuples(index=False):
        trial = JudgedTrial(
            kind=str(row.kind),
            part=str(row.part),
            conditions=conditions.get(row.trial, ()),
            expected=_number(row.expected),
            instructed=_number(row.instructed),
        )
        failed[int(str(row.study_session)), trial.kind] += study.failed(trial, answers[row.trial])
    return failed


def _number(value: object) -> int | None:
    number = float(str(value))
    return None if np.isnan(number) else int(number)
