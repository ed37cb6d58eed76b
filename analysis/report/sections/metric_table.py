"""Automatic metrics in the shape of the papers' Table 1: conditions as rows, metrics as columns."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from string import ascii_lowercase
from typing import Final

from analysis.measurement.scores import ConditionScore
from analysis.metrics.result import Better
from analysis.report import wording
from analysis.report.content import Cell, Table, counted
from analysis.report.texts import paragraphs


@dataclass(frozen=True)
class TableColumn:
    """One column of a paper's table.

    Attributes
    ----------
    metric : str
        Name of the score.
    label : str
        How the paper heads the column.
    better : {'lower', 'higher', 'near the reference', 'unsaid'}
        Which scores the paper calls better.
    block : str
        Heading over several columns; empty where the table has none.
    """

    metric: str
    label: str
    better: Better
    block: str = ""


SCORES: Final = "metrics.csv"
"""File in the report's ``tables`` folder with all scores of conditions, settings and reasons."""

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
    recorded, broken : str or None
        Recorded motion, and the visibly broken motion of catch trials; neither is ranked.
    generative : mapping of str to bool
        Whether a condition can move differently to one speech, where that is stated.
    """

    names: tuple[str, ...]
    recorded: str | None = None
    broken: str | None = None
    generative: Mapping[str, bool] = field(default_factory=dict)

    @property
    def ranked(self) -> tuple[int, ...]:
        """Places of the conditions that compete."""
        return tuple(
            place
            for place, name in enumerate(self.names)
            if name not in (self.recorded, self.broken)
        )


Scores = Mapping[tuple[str, str], ConditionScore]
"""By condition and metric."""


def metric_table(
    columns: Sequence[TableColumn],
    scores: Scores,
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
        From the left; those of one block beside each other.
    scores : mapping of (condition, metric) to ConditionScore
        What was measured; what is not among them is missing.
    systems : Systems
        The rows.
    caption, name : str
        See `analysis.report.content.Table`.
    marks_generative : bool
        Whether each block ends with a mark of generative conditions, where any is stated.
    """
    why = {
        (column, name): _why(column, name, scores, systems)
        for column in columns
        for name in systems.names
    }
    reasons = dict.fromkeys(reason for said in why.values() for reason in said)
    letters = {reason: _letter(number) for number, reason in enumerate(reasons)}
    header, filled, groups = [], [], [("", 1)]
    for block, own in groupby(columns, key=lambda column: column.block):
        inside = list(own)
        header += [_heading(column, scores, systems) for column in inside]
        filled += [_column(column, scores, systems, why, letters) for column in inside]
        # DiffSHEG marks its blocks of expression and gesture, not the holistic one.
        gen = marks_generative and bool(systems.generative) and len(inside) > 1
        if gen:
            header.append("Gen")
            filled.append([_generative(system, systems) for system in systems.names])
        groups.append((block, len(inside) + gen))
    left = ((systems.recorded, "recorded"), (systems.broken, "catch trials"))
    notes = paragraphs(
        "metrics.notes",
        arrows=ARROWS,
        used={column.better for column in columns},
        unranked=[
            f"{wording.condition(name)} ({what})" for name, what in left if name in systems.names
        ],
        has_spread=any("±" in cell.text for column in filled for cell in column),
        has_recorded=systems.recorded in systems.names,
        footnotes=[(letters[reason], _said_of(reason, why), reason) for reason in reasons],
        systems=len(systems.names),
        settings=_settings(columns, scores),
    )
    return Table(
        caption=caption,
        header=("condition", *header),
        rows=tuple(
            (Cell(text=wording.condition(system)), *(column[place] for column in filled))
            for place, system in enumerate(systems.names)
        ),
        groups=tuple(groups) if any(block for block, _ in groups) else (),
        notes=notes,
        name=name,
        data=SCORES,
    )


_Why = Mapping[tuple[TableColumn, str], Sequence[str]]
"""What must be known of a score, or why there is none, by column and condition."""


def _why(column: TableColumn, name: str, scores: Scores, systems: Systems) -> list[str]:
    score = scores.get((name, column.metric))
    if score is not None:
        return [reason for reason in (score.reason, score.remark) if reason]
    if name == systems.recorded and any((one, column.metric) in scores for one in systems.names):
        return ["recorded motion is not compared with itself"]
    return ["not measured"]


def _said_of(reason: str, why: _Why) -> list[tuple[list[str], list[str]]]:
    """Return columns, and the conditions that a reason is about in all of these."""
    about: dict[str, list[str]] = {}
    for (column, name), said in why.items():
        if reason in said:
            label = f"{column.block.lower()} {column.label}".strip()
            about.setdefault(label, []).append(wording.condition(name))
    alike: dict[tuple[str, ...], list[str]] = {}
    for label, names in about.items():
        alike.setdefault(tuple(names), []).append(label)
    return [(labels, [*names]) for names, labels in alike.items()]


def _letter(number: int) -> str:
    rest, place = divmod(number, len(ascii_lowercase))
    return (_letter(rest - 1) if rest else "") + ascii_lowercase[place]


def _heading(column: TableColumn, scores: Scores, systems: Systems) -> str:
    found = (scores.get((name, column.metric)) for name in systems.names)
    unit = next((score.unit for score in found if score is not None), "")
    return f"{column.label} {ARROWS[column.better]}".strip() + (f" ({unit})" if unit else "")


def _column(
    column: TableColumn, scores: Scores, systems: Systems, why: _Why, letters: Mapping[str, str]
) -> list[Cell]:
    found = {name: scores.get((name, column.metric)) for name in systems.names}
    values = {name: math.nan if one is None else one.value for name, one in found.items()}
    decimals = _decimals([score for score in found.values() if score is not None])
    ranked = [
        values[name] if place in systems.ranked else math.nan
        for place, name in enumerate(systems.names)
    ]
    recorded = values.get(systems.recorded or "", math.nan)
    best, second = first_and_second(ranked, column.better, recorded, decimals)
    marks = {name: ", ".join(letters[one] for one in why[column, name]) for name in systems.names}
    return [
        counted(
            value,
            _text(found[name], decimals)
            + (f"{wording.NO_BREAK}({marks[name]})" if marks[name] else ""),
            best=place in best,
            second=place in second,
        )
        for place, (name, value) in enumerate(values.items())
    ]


def _text(score: ConditionScore | None, decimals: int) -> str:
    if score is None or math.isnan(score.value):
        return "–"
    value = wording.fixed(score.value, decimals)
    if score.interval is not None:
        low, high = (wording.fixed(end, decimals) for end in score.interval)
        return f"{value}{wording.NO_BREAK}[{low},{wording.NO_BREAK}{high}]"
    if math.isnan(score.spread):
        return value
    return f"{value}{wording.NO_BREAK}±{wording.NO_BREAK}{wording.fixed(score.spread, decimals)}"


def _decimals(scores: Sequence[ConditionScore]) -> int:
    """Return how many decimals show what differs between conditions and no more."""
    spreads = [abs(score.spread) for score in scores if score.spread > 0]
    if spreads:
        return min(4, wording.decimals([statistics.median(spreads)], digits=2))
    values = [abs(score.value) for score in scores if abs(score.value) > 0]
    return min(4, wording.decimals([statistics.median(values)], digits=3)) if values else 0


def _generative(name: str, systems: Systems) -> Cell:
    known = systems.generative.get(name)
    if name == systems.recorded or known is None:
        return Cell(text="–")
    return Cell(text="✓" if known else "✗", value=float(known))


def _settings(columns: Sequence[TableColumn], scores: Scores) -> dict[str, list[str]]:
    """Return the metrics that share them by settings, in words."""
    shared: dict[str, list[str]] = {}
    for column in columns:
        found = [score for (_, metric), score in scores.items() if metric == column.metric]
        settings = found[0].settings if found else {}
        words = "; ".join(f"{key}: {value}" for key, value in settings.items())
        if words:
            shared.setdefault(words.replace("_", " "), []).append(column.label)
    return shared


def first_and_second(
    scores: Sequence[float], better: Better, recorded: float, decimals: int
) -> tuple[frozenset[int], frozenset[int]]:
    """Return the places of the best scores and of the second best.

    Scores that are the same as they are printed share a rank. Where all are the same, or there is
    one, none is best.

    Parameters
    ----------
    scores : sequence of float
        NaN where there is none, which has no rank.
    better : {'lower', 'higher', 'near the reference', 'unsaid'}
        Which scores are better.
    recorded : float
        The score of recorded motion, for nearness to it; NaN where it is not known.
    decimals : int
        As many as are printed.
    """
    printed = round(recorded, decimals)
    distances = {}
    for place, score in enumerate(scores):
        distance = _distance(round(score, decimals), better, printed)
        if not math.isnan(distance):
            # Rounded once more: differences of decimal numbers are not exact.
            distances[place] = round(distance, decimals)
    ranks = sorted(set(distances.values()))
    if len(ranks) < 2:
        return frozenset(), frozenset()
    best, second = (
        frozenset(place for place, distance in distances.items() if distance == rank)
        for rank in ranks[:2]
    )
    return best, second


def _distance(score: float, better: Better, recorded: float) -> float:
    """Return how far a score is from the best that there could be; NaN where that is not said."""
    match better:
        case "lower":
            return score
        case "higher":
            return -score
        case "near the reference":
            return abs(score - recorded)
        case _:
            return math.nan
