"""Reading a platform's table of answers."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.tables.answers import AnswerTable
from analysis.tables.cells import Cells, read_cells
from analysis.tables.checking import Checking
from analysis.tables.columns import MISSING, SHARED, Column
from analysis.tables.layout import Layout
from analysis.trial_kinds import ANALYSED_KINDS

NOT_EXCLUDED: Final = frozenset({"false", "0", "no", "n", "f"})
EXCLUDED: Final = frozenset({"true", "1", "yes", "y", "t", "x"})
MARKED: Final = "marked as excluded in the table"

_COLUMN: Final = {column.name: column for column in SHARED}

Rows = NDArray[np.bool_]


def read_answers(path: Path, layout: Layout) -> AnswerTable:
    """Read and check a table of answers.

    Parameters
    ----------
    path : Path
        CSV in UTF-8 with a header line, or Parquet.
    layout : Layout
        The protocol's columns.

    Raises
    ------
    InputError
        If the file cannot be read, a column is missing, a cell does not hold what its column
        states, or an answer occurs twice; it names the file, the row and the column.
    """
    columns = (*SHARED, *layout.columns)
    cells = read_cells(
        path,
        [column.name for column in columns],
        [column.name for column in columns if column.required],
    )
    everything = Checking(cells)
    people = everything.names(_COLUMN["participant"])
    kinds = _kinds(everything)
    judged = ("catch",) if layout.has_sides else ()
    used = np.isin(kinds, (*ANALYSED_KINDS, "practice", *judged))
    checking = Checking(cells.part(used), np.isin(kinds[used], ANALYSED_KINDS))
    answers = _answers(layout, checking, kinds[used])
    _refuse_contradictions(layout, checking, answers)
    _refuse_unjudged(checking, answers)
    if "trial" in cells.rows or layout.answered_once:
        _refuse_repetitions(layout, checking, answers)
    analysed = checking.analysed & answers["value"].notna().to_numpy(bool)
    conditions = _appearing(answers[[column.name for column in layout.conditions]], analysed)
    for column in layout.conditions:
        answers[column.name] = answers[column.name].cat.set_categories(list(conditions))
    return AnswerTable(
        protocol=layout.protocol,
        answers=answers[answers["value"].notna()].reset_index(drop=True),
        participants=tuple(map(str, people.categories)),
        marked=_marked(everything.names(_COLUMN["excluded"]), people),
        conditions=conditions,
        questions=_appearing(answers[["question"]], analysed),
        sets=_appearing(answers[["set"]], analysed),
        notes=_notes(cells, kinds, layout, int(answers["value"].isna().sum())),
    )


def _kinds(checking: Checking) -> NDArray[np.object_]:
    """Return the kind of every row's trial; a trial is a main one unless the table says else."""
    kinds = checking.names(_COLUMN["kind"])
    names = np.array([*kinds.categories, "main"], object)
    return np.asarray(names[kinds.codes], object)


def _answers(layout: Layout, checking: Checking, kinds: NDArray[np.object_]) -> pd.DataFrame:
    named: list[Column] = [
        *(_COLUMN[name] for name in ("participant", "segment", "question", "trial")),
        _COLUMN["correct_side"],
        *layout.conditions,
        *layout.others,
    ]
    sets = checking.names(_COLUMN["set"])
    columns: dict[str, object] = {column.name: checking.names(column) for column in named}
    return pd.DataFrame(
        columns
        | {
            "set": sets if len(sets.categories) else pd.Categorical([""] * len(kinds), [""]),
            "kind": pd.Categorical(kinds, pd.unique(kinds)),
            "value": checking.numbers(layout.value),
            "seconds": checking.numbers(_COLUMN["response_seconds"]),
        }
    )


def _refuse_contradictions(layout: Layout, checking: Checking, answers: pd.DataFrame) -> None:
    checking.refuse(
        checking.analysed & layout.wrong(answers),
        layout.columns[-2].name,
        lambda _: layout.contradiction,
        "Correct the row, or remove it",
    )


def _refuse_unjudged(checking: Checking, answers: pd.DataFrame) -> None:
    checking.refuse(
        np.asarray((answers["kind"] == "catch") & answers["correct_side"].isna(), bool),
        "correct_side",
        lambda _: "a catch trial has no correct side",
        "Write left or right into it, or remove the row",
    )


def _refuse_repetitions(layout: Layout, checking: Checking, answers: pd.DataFrame) -> None:
    shown = [column.name for column in (*layout.conditions, *layout.others)]
    key = ["participant", "set", "segment", "question", *shown]
    if layout.answered_once:
        # Practice trials come back as repeated ones; only the latter are analysed.
        answers = answers.assign(trial=answers["kind"].isin(ANALYSED_KINDS).astype("category"))
    else:
        key.append("kind")
    key.append("trial")
    codes = pd.DataFrame({name: answers[name].cat.codes for name in key})
    group = codes.groupby(key, sort=False).ngroup().to_numpy()
    first = pd.Series(np.arange(len(group))).groupby(group).transform("first").to_numpy()
    checking.refuse(
        np.asarray(first != np.arange(len(group)), bool),
        "trial",
        lambda row: f"the same answer stands in row {checking.number_of(int(first[row]))} already",
        "Remove one of them, or number trials apart",
    )


def _appearing(columns: pd.DataFrame, where: Rows) -> tuple[str, ...]:
    """Return the names of rows `where`, in the order in which all rows name them."""
    names = columns.astype(object).to_numpy()
    wanted = {name for name in pd.unique(names[where].ravel()) if not pd.isna(name)}
    return tuple(str(name) for name in pd.unique(names.ravel()) if name in wanted)


def _marked(excluded: pd.Categorical, people: pd.Categorical) -> dict[str, str]:
    """Return why the table itself excludes people; the first reason of each counts."""
    reasons = [_reason(str(text)) for text in excluded.categories]
    reason = np.append(np.array(reasons, object), "")[excluded.codes]
    marked = np.flatnonzero(reason != "")
    found: dict[str, str] = {}
    for row in marked[np.unique(people.codes[marked], return_index=True)[1]]:
        found[str(people[row])] = str(reason[row])
    return found


def _reason(text: str) -> str:
    word = text.lower().removesuffix(".0")
    if text in MISSING or word in NOT_EXCLUDED:
        return ""
    return MARKED if word in EXCLUDED else text


def _notes(
    cells: Cells, kinds: NDArray[np.object_], layout: Layout, unanswered: int
) -> tuple[str, ...]:
    notes = []
    if cells.ignored:
        notes.append(f"Columns that are not read: {', '.join(cells.ignored)}.")
    if unanswered:
        notes.append(f"{_rows(unanswered)} without a {layout.value.name} left out.")
    if attention := int((kinds == "attention").sum()):
        notes.append(
            f"{_rows(attention)} of attention checks left out; a table does not say what they ask "
            "for, so that they exclude nobody by themselves."
        )
    if not layout.has_sides and (catch := int((kinds == "catch").sum())):
        notes.append(
            f"{_rows(catch)} of catch trials left out; a {layout.protocol} has no correct side, "
            "so that they exclude nobody by themselves."
        )
    return tuple(notes)


def _rows(count: int) -> str:
    return f"{count:,} row{' is' if count == 1 else 's are'}"
