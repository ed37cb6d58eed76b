"""Automatic metrics in the shape of the papers' Table 1: conditions as rows, metrics as columns."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from string import ascii_lowercase
from typing import Final

from analysis.measurement.scores import ConditionScore
from analysis.metrics.result import Better
from analysis.report import wording
from analysis.report.content import Cell, Table
from motion.errors import listed


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

YES: Final = "✓"
NO: Final = "✗"

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
    footnotes = _Footnotes(len(systems.names))
    header, filled, groups = [], [], [("", 1)]
    for block, own in groupby(columns, key=lambda column: column.block):
        inside = list(own)
        header += [_heading(column, scores, systems) for column in inside]
        filled += [_column(column, scores, systems, footnotes) for column in inside]
        # DiffSHEG marks its blocks of expression and gesture, not the holistic one.
        gen = marks_generative and bool(systems.generative) and len(inside) > 1
        if gen:
            header.append("Gen")
            filled.append([_generative(system, systems) for system in systems.names])
        groups.append((block, len(inside) + gen))
    return Table(
        caption=caption,
        header=("condition", *header),
        rows=tuple(
            (Cell(text=wording.condition(system)), *(column[place] for column in filled))
            for place, system in enumerate(systems.names)
        ),
        groups=tuple(groups) if any(block for block, _ in groups) else (),
        notes=(
            *_reading(columns, systems, any("±" in c.text for column in filled for c in column)),
            *footnotes.texts(),
            *settings_notes(columns, scores),
        ),
        name=name,
        data=SCORES,
    )


@dataclass
class _Footnotes:
    """Reasons with a letter each, given out in the order in which cells need them."""

    _rows: int
    _subjects: dict[str, dict[str, list[str]]] = field(default_factory=dict)

    def letter(self, reason: str, label: str, condition: str) -> str:
        """Return the letter of `reason`, and remember what it is about."""
        about = self._subjects.setdefault(reason, {})
        about.setdefault(label, []).append(wording.condition(condition))
        return _letter(list(self._subjects).index(reason))

    def texts(self) -> Iterator[str]:
        """Yield the footnotes."""
        for number, (reason, about) in enumerate(self._subjects.items()):
            alike: dict[tuple[str, ...], list[str]] = {}
            for label, names in about.items():
                alike.setdefault(tuple(names), []).append(label)
            parts = [
                listed(labels) + ("" if len(names) == self._rows else f" of {listed(list(names))}")
                for names, labels in alike.items()
            ]
            yield f"({_letter(number)}) {'; '.join(parts)}: {reason.rstrip('.')}."


def _letter(number: int) -> str:
    rest, place = divmod(number, len(ascii_lowercase))
    return (_letter(rest - 1) if rest else "") + ascii_lowercase[place]


def _heading(column: TableColumn, scores: Scores, systems: Systems) -> str:
    unit = next(
        (scores[s, column.metric].unit for s in systems.names if (s, column.metric) in scores), ""
    )
    arrow = ARROWS[column.better]
    return f"{column.label}{f' {arrow}' if arrow else ''}{f' ({unit})' if unit else ''}"


def _column(
    column: TableColumn, scores: Scores, systems: Systems, footnotes: _Footnotes
) -> list[Cell]:
    found = [scores.get((name, column.metric)) for name in systems.names]
    values = [math.nan if score is None else score.value for score in found]
    decimals = _decimals([score for score in found if score is not None])
    recorded = next(
        (v for name, v in zip(systems.names, values, strict=True) if name == systems.recorded),
        math.nan,
    )
    ranked = [value if place in systems.ranked else math.nan for place, value in enumerate(values)]
    best, second = first_and_second(ranked, column.better, recorded, decimals)
    return [
        Cell(
            text=_text(score, decimals)
            + _mark(score, column, name, footnotes, _absent(name, systems, found)),
            value=None if math.isnan(value) else value,
            best=place in best,
            second=place in second,
        )
        for place, (name, score, value) in enumerate(zip(systems.names, found, values, strict=True))
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


def _mark(
    score: ConditionScore | None,
    column: TableColumn,
    condition: str,
    footnotes: _Footnotes,
    absent: str,
) -> str:
    """Return the letters of what must be known of a score, or of why there is none."""
    reasons = [absent] if score is None else [score.reason, score.remark]
    label = f"{column.block.lower()} {column.label}".strip()
    letters = [footnotes.letter(reason, label, condition) for reason in reasons if reason]
    return f"{wording.NO_BREAK}({', '.join(letters)})" if letters else ""


def _absent(condition: str, systems: Systems, found: Sequence[ConditionScore | None]) -> str:
    """Return why a condition has no score at all."""
    if condition == systems.recorded and any(score is not None for score in found):
        return "recorded motion is not compared with itself"
    return "not measured"


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
    return Cell(text=YES if known else NO, value=float(known))


def _reading(columns: Sequence[TableColumn], systems: Systems, has_spread: bool) -> Iterator[str]:
    """Yield how the table is read."""
    used = {column.better for column in columns}
    words = [
        f"{ARROWS[better]} {text}"
        for better, text in (
            ("lower", "lower is better"),
            ("higher", "higher is better"),
            ("near the reference", "nearest to recorded motion is best"),
        )
        if better in used
    ]
    left = [
        f"{wording.condition(name)} ({what})"
        for name, what in ((systems.recorded, "recorded"), (systems.broken, "catch trials"))
        if name is not None and name in systems.names
    ]
    yield (
        f"{'; '.join(words)}{'. ' if words else ''}Best in bold, second best underlined, equal "
        f"ones alike{f'; {listed(left)} not ranked' if left else ''}."
        + (" ±: standard deviation between clips." if has_spread else "")
    )
    if "near the reference" in used and (systems.recorded not in systems.names):
        yield "No recorded motion was measured, so nothing is nearest to it."


def settings_notes(columns: Sequence[TableColumn], scores: Scores) -> list[str]:
    """Return one note per set of settings, naming all metrics that share it."""
    shared: dict[str, list[str]] = {}
    for column in columns:
        found = [score for (_, metric), score in scores.items() if metric == column.metric]
        settings = found[0].settings if found else {}
        words = "; ".join(f"{key}: {value}" for key, value in settings.items())
        if words:
            shared.setdefault(words.replace("_", " "), []).append(column.label)
    return [f"{listed(sharing)} – {words}." for words, sharing in shared.items()]


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
