"""Tables of automatic metrics as in the papers' Table 1: conditions in rows, metrics in columns."""

import math
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from string import ascii_lowercase
from typing import Final

import numpy as np
import pandas as pd

from analysis.metrics.scores import Better, ConditionScore
from analysis.report import wording
from analysis.report.content import Cell, Table, number_cell
from analysis.report.texts import paragraphs


@dataclass(frozen=True)
class TableColumn:
    """One column of a paper's table.

    Attributes
    ----------
    metric : str
        Name of the metric.
    label : str
        The paper's heading of the column.
    better : {'lower', 'higher', 'near the reference', 'unsaid'}
        Which scores the paper calls better.
    block : str
        Heading over several columns; empty for none.
    """

    metric: str
    label: str
    better: Better
    block: str = ""


SCORES: Final = "metrics.csv"
"""File in the report's ``tables`` folder with all scores of conditions."""

ARROWS: Final[dict[Better, str]] = {
    "lower": "↓",
    "higher": "↑",
    "near the reference": "→",
    "unsaid": "",
}


@dataclass(frozen=True, kw_only=True)
class Systems:
    """The rows of a table of metrics.

    Attributes
    ----------
    names : tuple of str
        Conditions from the top.
    scores : mapping of (condition, metric) to ConditionScore
        All measured scores.
    recorded, broken : str or None
        Recorded motion, and the visibly broken motion of catch trials; neither is ranked.
    generative : mapping of str to bool
        Whether a condition can move differently to the same speech, if stated.
    """

    names: tuple[str, ...]
    scores: Mapping[tuple[str, str], ConditionScore]
    recorded: str | None
    broken: str | None
    generative: Mapping[str, bool]

    def scores_of(self, metric: str) -> dict[str, ConditionScore | None]:
        """Return the score of every condition, None for those not measured."""
        return {name: self.scores.get((name, metric)) for name in self.names}


def metric_table(
    columns: Sequence[TableColumn],
    systems: Systems,
    *,
    caption: str,
    name: str,
    marks_generative: bool = False,
) -> Table:
    """Return a table of metrics.

    Parameters
    ----------
    columns : sequence of TableColumn
        From the left; columns of one block are adjacent.
    systems : Systems
        The rows.
    caption, name : str
        See `analysis.report.content.Table`.
    marks_generative : bool
        Whether each block ends with a column that marks generative conditions, if stated.
    """
    remarks = {
        (column, name): _remarks(column, name, systems)
        for column in columns
        for name in systems.names
    }
    unique = dict.fromkeys(remark for in_cell in remarks.values() for remark in in_cell)
    letters = {remark: _letter(number) for number, remark in enumerate(unique)}
    header, cells, groups = [], [], [("", 1)]
    for block, columns_of_block in groupby(columns, key=lambda column: column.block):
        in_block = list(columns_of_block)
        header += [_heading(column, systems) for column in in_block]
        cells += [_column(column, systems, remarks, letters) for column in in_block]
        # DiffSHEG marks its blocks of expression and gesture, not the holistic one.
        has_mark = marks_generative and bool(systems.generative) and len(in_block) > 1
        if has_mark:
            header.append("Gen")
            cells.append([_generative(name, systems) for name in systems.names])
        groups.append((block, len(in_block) + has_mark))
    unranked = ((systems.recorded, "recorded"), (systems.broken, "catch trials"))
    notes = paragraphs(
        "metrics.notes",
        arrows=ARROWS,
        used={column.better for column in columns},
        unranked=[
            f"{wording.condition(name)} ({kind})"
            for name, kind in unranked
            if name in systems.names
        ],
        has_spread=any("±" in cell.text for column in cells for cell in column),
        has_recorded=systems.recorded in systems.names,
        footnotes=[(letters[remark], _places_of(remark, remarks), remark) for remark in unique],
        systems=len(systems.names),
        labels_by_settings=_labels_by_settings(columns, systems),
    )
    return Table(
        caption=caption,
        header=("condition", *header),
        rows=tuple(
            (Cell(text=wording.condition(name)), *(column[index] for column in cells))
            for index, name in enumerate(systems.names)
        ),
        groups=tuple(groups) if any(block for block, _ in groups) else (),
        notes=notes,
        name=name,
        data=SCORES,
    )


_Remarks = Mapping[tuple[TableColumn, str], Sequence[str]]
"""Remarks on a score, or why there is none, by column and condition."""


def _remarks(column: TableColumn, name: str, systems: Systems) -> list[str]:
    scores = systems.scores_of(column.metric)
    score = scores[name]
    if score is not None:
        return [remark for remark in (score.reason, score.remark) if remark]
    if name == systems.recorded and any(scores.values()):
        return ["recorded motion is not compared with itself"]
    return ["not measured"]


def _places_of(remark: str, remarks: _Remarks) -> list[tuple[list[str], list[str]]]:
    """Return groups of columns, each with the conditions that have the remark in all of them."""
    conditions: dict[str, list[str]] = {}
    for (column, name), in_cell in remarks.items():
        if remark in in_cell:
            label = f"{column.block.lower()} {column.label}".strip()
            conditions.setdefault(label, []).append(wording.condition(name))
    labels: dict[tuple[str, ...], list[str]] = {}
    for label, names in conditions.items():
        labels.setdefault(tuple(names), []).append(label)
    return [(grouped, [*names]) for names, grouped in labels.items()]


def _letter(number: int) -> str:
    """Return a, b, …, z, aa, ab, … for 0, 1, …."""
    before, last = divmod(number, len(ascii_lowercase))
    return (_letter(before - 1) if before else "") + ascii_lowercase[last]


def _heading(column: TableColumn, systems: Systems) -> str:
    unit = next((score.unit for score in systems.scores_of(column.metric).values() if score), "")
    return f"{column.label} {ARROWS[column.better]}".strip() + (f" ({unit})" if unit else "")


def _column(
    column: TableColumn, systems: Systems, remarks: _Remarks, letters: Mapping[str, str]
) -> list[Cell]:
    scores = systems.scores_of(column.metric)
    values = {name: score.value if score else math.nan for name, score in scores.items()}
    decimals = _decimals([score for score in scores.values() if score])
    ranked = [
        math.nan if name in (systems.recorded, systems.broken) else value
        for name, value in values.items()
    ]
    recorded = values.get(systems.recorded or "", math.nan)
    best, second = first_and_second(ranked, column.better, recorded, decimals)
    cells = []
    for index, (name, value) in enumerate(values.items()):
        text = _text(scores[name], decimals)
        if remarks[column, name]:
            marks = ", ".join(letters[remark] for remark in remarks[column, name])
            text += f"{wording.NO_BREAK}({marks})"
        cells.append(number_cell(value, text, best=index in best, second=index in second))
    return cells


def _text(score: ConditionScore | None, decimals: int) -> str:
    if score is None or math.isnan(score.value):
        return "–"
    value = wording.fixed(score.value, decimals)
    if score.interval is not None:
        low, high = (wording.fixed(end, decimals) for end in score.interval)
        return f"{value}{wording.NO_BREAK}{wording.between(low, high)}"
    if math.isnan(score.spread):
        return value
    return f"{value}{wording.NO_BREAK}±{wording.NO_BREAK}{wording.fixed(score.spread, decimals)}"


def _decimals(scores: Sequence[ConditionScore]) -> int:
    """Return the number of decimals that shows the differences between conditions."""
    spreads = [score.spread for score in scores if score.spread > 0]
    if spreads:
        return min(4, wording.decimals([statistics.median(spreads)], digits=2))
    values = [abs(score.value) for score in scores if abs(score.value) > 0]
    return min(4, wording.decimals([statistics.median(values)], digits=3)) if values else 0


def _generative(name: str, systems: Systems) -> Cell:
    is_generative = systems.generative.get(name)
    if name == systems.recorded or is_generative is None:
        return Cell(text="–")
    return Cell(text="✓" if is_generative else "✗", value=float(is_generative))


def _labels_by_settings(columns: Sequence[TableColumn], systems: Systems) -> dict[str, list[str]]:
    """Return settings in words, each with the metrics that have them."""
    labels: dict[str, list[str]] = {}
    for column in columns:
        scores = systems.scores_of(column.metric).values()
        settings = next((score.settings for score in scores if score), {})
        words = "; ".join(f"{name}: {value}" for name, value in settings.items())
        if words:
            labels.setdefault(words.replace("_", " "), []).append(column.label)
    return labels


def first_and_second(
    scores: Sequence[float], better: Better, recorded: float, decimals: int
) -> tuple[set[int], set[int]]:
    """Return the indices of the best scores and of the second best.

    Scores that are printed alike share a rank. If all are printed alike, none is best.

    Parameters
    ----------
    scores : sequence of float
        NaN for no score, which has no rank.
    better : {'lower', 'higher', 'near the reference', 'unsaid'}
        Which scores are better.
    recorded : float
        The score of recorded motion; NaN if unknown.
    decimals : int
        Number of decimals printed.
    """
    printed = np.array([round(score, decimals) for score in scores])
    distances = {
        "lower": printed,
        "higher": -printed,
        "near the reference": np.abs(printed - round(recorded, decimals)),
    }.get(better, np.full(len(printed), math.nan))
    # Rounded again: differences of decimal numbers are not exact.
    places = pd.Series(distances).round(decimals).rank(method="dense")
    if not places.max() > 1:
        return set(), set()
    return set(places.index[places == 1]), set(places.index[places == 2])
