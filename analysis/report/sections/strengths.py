"""Bradley-Terry strengths and Plackett-Luce worths as a figure and as tables."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Final, NamedTuple

from analysis.report import wording
from analysis.report.content import About, Picture, Table
from analysis.report.figures.dots import Dot, dot_pictures
from analysis.report.figures.panels import Row
from analysis.report.figures.style import Scale
from analysis.report.texts import table
from analysis.report.wording import SIGNIFICANCE, between, number, ranks
from analysis.results.strengths import StrengthContrast, Strengths, Worths
from analysis.stats.clustered_mean import LEVEL

Fitted = Strengths | Worths

_STANDINGS: Final = {
    "strengths": (
        "strength",
        "bradley_terry.csv",
        "Bradley–Terry strengths over all comparisons (Davidson's ties, left-side term), in logits "
        f"that add up to zero, and the ranks that each condition may have at {LEVEL:.0%}. After "
        "exclusions.",
    ),
    "worths": (
        "worth",
        "plackett_luce.csv",
        "Plackett–Luce worths of the rankings after exclusions (ties included), on a log scale on "
        f"which they add up to zero, and the ranks that each condition may have at {LEVEL:.0%}.",
    ),
}
"""What one value is called, the file with all that is known of them, and the table's caption."""


def strength_pictures(found: Mapping[str, Fitted], axis: str, told: About) -> tuple[Picture, ...]:
    """Draw a panel per question and a row per condition, the strongest on the first one on top.

    Parameters
    ----------
    found : mapping of str to Strengths or Worths
        By question; those without a fit are left out, and without any nothing is drawn.
    axis : str
        What the values are.
    told : About
        What stands around the figure.
    """
    known = {question: one for question, one in found.items() if not one.reason and _values(one)}
    if not known:
        return ()
    order = strongest_first(known, [name for one in known.values() for name in _values(one)])
    return dot_pictures(
        {question: [_dot(one, name) for name in order] for question, one in known.items()},
        [Row(wording.condition(name)) for name in order],
        Scale(label=axis, line=0.0),
        told,
    )


def strongest_first(found: Mapping[str, Fitted], names: Iterable[str]) -> list[str]:
    """Return each name once, by the strengths on the first question that has some."""
    values = next((_values(one) for one in found.values() if not one.reason), {})
    known = {name: value for name, value in values.items() if not math.isnan(value)}
    return sorted(dict.fromkeys(names), key=lambda name: -known.get(name, -math.inf))


def _dot(fitted: Fitted, name: str) -> Dot:
    value = _values(fitted).get(name, math.nan)
    if math.isnan(value):
        return Dot(words="–", hint="not known")
    low, high, rank = fitted.low[name], fitted.high[name], ranks(fitted.ranks.get(name))
    inside = "" if math.isnan(low) else f" {between(number(low), number(high))}"
    return Dot(
        estimate=value,
        low=low,
        high=high,
        words=number(value),
        below=f"rank {rank}" if rank != "–" else "",
        hint=f"{number(value)}{inside}, rank {rank}",
    )


class _Standing(NamedTuple):
    question: str
    condition: str
    value: float
    error: float
    low: float
    high: float
    ranks: str


def standings_table(found: Mapping[str, Fitted], kind: str) -> Table:
    """Return values, errors and ranks by question, the strongest condition first.

    Parameters
    ----------
    found : mapping of str to Strengths or Worths
        By question.
    kind : {'strengths', 'worths'}
        Which of them.
    """
    what, data, caption = _STANDINGS[kind]
    rows = [
        _Standing(
            question,
            name,
            value,
            fitted.errors[name]
            if math.isnan(fitted.errors_two_way[name])
            else fitted.errors_two_way[name],
            fitted.low[name],
            fitted.high[name],
            ranks(fitted.ranks.get(name)),
        )
        for question, fitted in found.items()
        for name, value in sorted(
            _values(fitted).items(), key=lambda pair: (math.isnan(pair[1]), -pair[1])
        )
    ]
    return table("standings", rows, what=(what, kind), data=data, caption=caption, fitted=found)


def _values(fitted: Fitted) -> Mapping[str, float]:
    return fitted.strengths if isinstance(fitted, Strengths) else fitted.worths


def contrasts_table(
    contrasts: Sequence[StrengthContrast], fitted: Mapping[str, Fitted], what: str
) -> Table:
    """Return how much stronger the first of every two conditions is.

    Parameters
    ----------
    contrasts : sequence of StrengthContrast
        Of one set.
    fitted : mapping of str to Strengths or Worths
        What they are differences of, by question.
    what : str
        What those are called.
    """
    shared = any(_share_ranks(one, fitted[one.question]) for one in contrasts)
    return table("contrasts", contrasts, fitted=fitted, what=what, shared=shared)


def _share_ranks(one: StrengthContrast, fitted: Fitted) -> bool:
    """Tell whether a decided difference is between conditions whose ranks overlap."""
    if not one.p_holm < SIGNIFICANCE or not fitted.ranks:
        return False
    a, b = fitted.ranks[one.a], fitted.ranks[one.b]
    return a.best <= b.worst and b.best <= a.worst
