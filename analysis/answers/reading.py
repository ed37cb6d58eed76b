"""Reading a platform's table of answers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.cells import Cells, Checking, read_cells
from analysis.answers.table import ANALYSED_KINDS, MISSING, SHARED, AnswerTable, Column, Layout
from motion.arrays import Bools

NOT_EXCLUDED: Final = frozenset({"false", "0", "no", "n", "f"})
EXCLUDED: Final = frozenset({"true", "1", "yes", "y", "t", "x"})
MARKED: Final = "marked as excluded in the table"

_COLUMN: Final = {column.name: column for column in SHARED}


SLIPS: Final = 0.05
"""Share of the ratings below which one far above all others may be a slip."""


@dataclass(frozen=True, kw_only=True)
class Order:
    """The order of names, if it is not that of appearance, and the questions' scales.

    Attributes
    ----------
    conditions, questions, sets : tuple of str
        Names in their order.
    scales : mapping of str to (int, int)
        The lowest and the highest rating that each question allows.
    """

    conditions: tuple[str, ...] = ()
    questions: tuple[str, ...] = ()
    sets: tuple[str, ...] = ()
    scales: Mapping[str, tuple[int, int]] = field(default_factory=dict)


AS_IT_COMES: Final = Order()


def read_answers(path: Path, layout: Layout, scale: tuple[int, int] | None = None) -> AnswerTable:
    """Read and check a table of answers.

    Parameters
    ----------
    path : Path
        CSV in UTF-8 with a header line, or Parquet.
    layout : Layout
        The protocol's columns.
    scale : (int, int), optional
        The lowest and the highest rating that could be given.

    Raises
    ------
    InputError
        If the file cannot be read, a column is missing, a cell does not hold what its column
        states, or an answer occurs twice; it names the file, the row and the column.
    """
    columns = (*SHARED, *layout.columns)
    return answers_in(
        read_cells(
            path,
            [column.name for column in columns],
            [column.name for column in columns if column.required],
        ),
        layout,
        scale=scale,
    )


def answers_in(
    cells: Cells,
    layout: Layout,
    order: Order = AS_IT_COMES,
    scale: tuple[int, int] | None = None,
) -> AnswerTable:
    """Check the cells of a table of answers.

    Parameters
    ----------
    cells : Cells
        Cells of the shared and the layout's columns; optional columns may be missing.
    layout : Layout
        The protocol's columns.
    order : Order
        The order of conditions, questions and sets; names that it lacks come last.
    scale : (int, int), optional
        The lowest and the highest rating that could be given.

    Raises
    ------
    InputError
        As in `read_answers`.
    """
    everything = Checking(cells)
    participants = everything.names(_COLUMN["participant"])
    stated = everything.names(_COLUMN["kind"])
    kinds = np.array([*stated.categories, "main"], object)[stated.codes]
    judged = ("catch",) if layout.has_sides else ()
    instructed = (kinds == "attention") & np.isfinite(everything.numbers(_COLUMN["instructed"]))
    used = np.isin(kinds, (*ANALYSED_KINDS, "practice", *judged)) | instructed
    checking = Checking(cells.part(used), np.isin(kinds[used], ANALYSED_KINDS))
    answers = _answers(layout, checking, kinds[used])
    if layout.answered_once:
        answers["trial"] = _ambiguous_trials(answers, layout)
    if layout.distinct is not None:
        left, right = (answers[name].astype(object) for name in layout.distinct)
        checking.refuse(
            checking.analysed & (left == right).to_numpy(bool),
            layout.distinct[1],
            lambda _: layout.contradiction,
            "Correct the row, or remove it",
        )
    checking.refuse(
        np.asarray((answers["kind"] == "catch") & answers["correct_side"].isna(), bool),
        "correct_side",
        lambda _: "a catch trial has no correct side",
        "Write left or right into it, or remove the row",
    )
    if scale is not None:
        low, high = scale
        values = answers["value"].to_numpy(np.float64)
        checking.refuse(
            (values < low) | (values > high),
            layout.value.name,
            lambda row: f"{values[row]:g} is not on the scale from {low} to {high}",
            "Correct the cell, or state another scale",
        )
    if "trial" in cells.rows or layout.answered_once:
        _refuse_repetitions(layout, checking, answers)
    analysed = checking.analysed & answers["value"].notna().to_numpy(bool)
    conditions = _ordered(
        _appearing(answers[[column.name for column in layout.conditions]], analysed),
        order.conditions,
    )
    for column in layout.conditions:
        answers[column.name] = answers[column.name].cat.set_categories(list(conditions))
    has_scale = scale is not None or bool(order.scales)
    questions = _ordered(_appearing(answers[["question"]], analysed), order.questions)
    return AnswerTable(
        protocol=layout.protocol,
        scales=dict.fromkeys(questions, scale) if scale is not None else order.scales,
        answers=answers[answers["value"].notna()].reset_index(drop=True),
        participants=tuple(map(str, participants.categories)),
        marked=_marked(everything.names(_COLUMN["excluded"]), participants),
        conditions=conditions,
        questions=questions,
        sets=_ordered(_appearing(answers[["set"]], analysed), order.sets),
        notes=tuple(_notes(cells, kinds, instructed, layout, answers, analysed, has_scale)),
    )


def _answers(layout: Layout, checking: Checking, kinds: NDArray[np.object_]) -> pd.DataFrame:
    named: list[Column] = [
        *(_COLUMN[name] for name in ("participant", "segment", "question", "trial")),
        *(_COLUMN[name] for name in ("correct_side", "emotion", "speaker")),
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
            "instructed": checking.numbers(_COLUMN["instructed"]),
            "seconds": checking.numbers(_COLUMN["response_seconds"]),
            "watched": checking.numbers(_COLUMN["watched"]),
        }
    )


def _refuse_repetitions(layout: Layout, checking: Checking, answers: pd.DataFrame) -> None:
    shown = [column.name for column in (*layout.conditions, *layout.others)]
    key = ["participant", "set", "segment", "question", *shown]
    may_repeat = np.zeros(len(answers), bool)
    if layout.answered_once:
        # Practice trials come back as repeated ones; only the latter are analysed.
        may_repeat = (answers["kind"] == "attention").to_numpy(bool)
        answers = answers.assign(kind=answers["kind"].isin(ANALYSED_KINDS).astype("category"))
    key += ["kind", "trial"]
    codes = pd.DataFrame({name: answers[name].cat.codes for name in key})
    group = codes.groupby(key, sort=False).ngroup().to_numpy()
    group = np.where(may_repeat, -1 - np.arange(len(group)), group)
    first = pd.Series(np.arange(len(group))).groupby(group).transform("first").to_numpy()
    checking.refuse(
        np.asarray(first != np.arange(len(group)), bool),
        "trial",
        lambda row: f"row {checking.number_of(int(first[row]))} already holds this answer",
        "Remove one of them, or give the trials different numbers",
    )


def _ambiguous_trials(answers: pd.DataFrame, layout: Layout) -> pd.Series[str]:
    """Return the trial of each answer that only its trial tells from another; else empty.

    A table may give every row its own trial number. Trials distinguish answers only if one question
    about a segment's condition was answered in several of them.
    """
    shared = ["participant", "set", "segment", "question"]
    about = [*shared, *(column.name for column in layout.conditions)]
    analysed = answers["kind"].isin(ANALYSED_KINDS)
    codes = pd.DataFrame({name: answers[name].cat.codes for name in about})
    twice = codes[analysed].duplicated(keep=False).reindex(codes.index, fill_value=False)
    repeated = twice.groupby([codes[name] for name in shared]).transform("any")
    return answers["trial"].where(repeated)


def _appearing(columns: pd.DataFrame, where: Bools) -> tuple[str, ...]:
    """Return the names in the rows `where`, in the order of appearance in all rows."""
    names = columns.astype(object).to_numpy()
    present = {name for name in pd.unique(names[where].ravel()) if not pd.isna(name)}
    return tuple(str(name) for name in pd.unique(names.ravel()) if name in present)


def _ordered(names: tuple[str, ...], order: tuple[str, ...]) -> tuple[str, ...]:
    """Return `names` in the given order; those that it lacks come last."""
    return tuple(dict.fromkeys((*(name for name in order if name in names), *names)))


def _marked(excluded: pd.Categorical, participants: pd.Categorical) -> dict[str, str]:
    """Return the first reason for which the table excludes each participant."""
    reasons = [_reason(str(text)) for text in excluded.categories]
    reason = np.append(np.array(reasons, object), "")[excluded.codes]
    marked = np.flatnonzero(reason != "")
    reasons_of: dict[str, str] = {}
    for row in marked[np.unique(participants.codes[marked], return_index=True)[1]]:
        reasons_of[str(participants[row])] = str(reason[row])
    return reasons_of


def _reason(text: str) -> str:
    word = text.lower().removesuffix(".0")
    if text in MISSING or word in NOT_EXCLUDED:
        return ""
    return MARKED if word in EXCLUDED else text


def _notes(
    cells: Cells,
    kinds: NDArray[np.object_],
    instructed: Bools,
    layout: Layout,
    answers: pd.DataFrame,
    analysed: Bools,
    has_scale: bool,
) -> Iterator[str]:
    if oddity := _oddity(answers, analysed, layout, has_scale=has_scale):
        yield oddity
    unanswered = answers["value"].isna()
    tells_apart = "trial" in cells.rows or layout.answered_once
    if not tells_apart and (repeated := int(answers[~unanswered].duplicated().sum())):
        yield (
            f"{_rows(repeated)} the same as an earlier one, and no column trial tells "
            "presentations apart: each counts as a separate answer. Is the table joined with "
            "itself?"
        )
    if cells.ignored:
        yield f"Columns that are not read: {', '.join(cells.ignored)}."
    if unanswered.any():
        yield f"{_rows(int(unanswered.sum()))} left out for lack of a {layout.value.name}."
    uninstructed = int(((kinds == "attention") & ~instructed).sum())
    # Of a ranking it is enough to ask for the place of one condition.
    if uninstructed and not (layout.answered_once and instructed.any()):
        yield (
            f"{_rows(uninstructed)} left out (attention checks): the table does not say what they "
            "ask for, so they exclude nobody by themselves."
        )
    if not layout.has_sides and (catch := int((kinds == "catch").sum())):
        yield (
            f"{_rows(catch)} left out (catch trials): a {layout.protocol} has no correct side, "
            "so they exclude nobody by themselves."
        )


def _oddity(answers: pd.DataFrame, analysed: Bools, layout: Layout, *, has_scale: bool) -> str:
    """Return a note about odd values in a table; empty if there are none."""
    shown = answers[analysed]
    if layout.protocol == "rating" and not has_scale:
        scores, counts = np.unique(shown["value"].to_numpy(np.float64), return_counts=True)
        if (
            len(scores) > 2
            and scores[-1] - scores[-2] > scores[-2] - scores[0]
            and counts[-1] < SLIPS * counts.sum()
        ):
            return (
                f"The highest rating, {scores[-1]:g}, was given {counts[-1]} time"
                f"{'s' * int(counts[-1] > 1)}; all others are {scores[-2]:g} or lower. It is "
                "analysed: state the scale (--scale) to have slips refused."
            )
    if layout.protocol == "ranking":
        named = ["participant", "set", "segment", "question", "trial"]
        ranking = shown.groupby(named, observed=True, dropna=False)["value"]
        before = ranking.rank(method="min") - 1
        gaps = shown["value"] - 1 > before
        count = gaps.groupby([shown[name].cat.codes for name in named]).any().sum()
        if count:
            return (
                f"{count} ranking{' leaves' if count == 1 else 's leave'} places out (1, 2, 4): "
                "only their order counts."
            )
    return ""


def _rows(count: int) -> str:
    return f"{count:,} row{' is' if count == 1 else 's are'}"
