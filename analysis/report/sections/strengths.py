"""Bradley-Terry strengths and Plackett-Luce worths as a figure and as tables."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from analysis.report import wording
from analysis.report.content import About, Picture, Table
from analysis.report.figures.dots import Dot, dot_pictures
from analysis.report.figures.panels import Row
from analysis.report.figures.style import Scale
from analysis.report.texts import table
from analysis.report.wording import SIGNIFICANCE, between, number, ranks
from analysis.results.strengths import Standing, Standings, StrengthContrast
from analysis.stats.clustered_mean import LEVEL

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


def strength_pictures(
    found: Mapping[str, Standings], axis: str, told: About
) -> tuple[Picture, ...]:
    """Draw a panel per question and a row per condition, the strongest on the first one on top.

    Parameters
    ----------
    found : mapping of str to Standings
        By question; those without a fit are left out, and without any nothing is drawn.
    axis : str
        What the values are.
    told : About
        What stands around the figure.
    """
    known = {question: one for question, one in found.items() if not one.reason and one.conditions}
    if not known:
        return ()
    rows = {question: {c.condition: c for c in one.conditions} for question, one in known.items()}
    order = strongest_first(known, [name for own in rows.values() for name in own])
    return dot_pictures(
        {question: [_dot(own.get(name)) for name in order] for question, own in rows.items()},
        [Row(wording.condition(name)) for name in order],
        Scale(label=axis, line=0.0),
        told,
    )


def strongest_first(found: Mapping[str, Standings], names: Iterable[str]) -> list[str]:
    """Return each name once, by the strengths on the first question that has some."""
    first = next((one.conditions for one in found.values() if not one.reason), ())
    known = {c.condition: c.estimate for c in first if not math.isnan(c.estimate)}
    return sorted(dict.fromkeys(names), key=lambda name: -known.get(name, -math.inf))


def _dot(found: Standing | None) -> Dot:
    if found is None or math.isnan(found.estimate):
        return Dot(words="–", hint="not known")
    rank = ranks(found)
    inside = f" {between(number(found.low), number(found.high))}" if found.has_interval else ""
    return Dot(
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        words=number(found.estimate),
        below=f"rank {rank}" if rank != "–" else "",
        hint=f"{number(found.estimate)}{inside}, rank {rank}",
    )


def standings_table(found: Mapping[str, Standings], kind: str) -> Table:
    """Return values, errors and ranks by question, the strongest condition first.

    Parameters
    ----------
    found : mapping of str to Standings
        By question.
    kind : {'strengths', 'worths'}
        Which of them.
    """
    what, data, caption = _STANDINGS[kind]
    rows = [
        (question, one)
        for question, fitted in found.items()
        for one in sorted(fitted.conditions, key=lambda c: (math.isnan(c.estimate), -c.estimate))
    ]
    return table("standings", rows, what=(what, kind), data=data, caption=caption, fitted=found)


def contrasts_table(
    contrasts: Sequence[StrengthContrast], fitted: Mapping[str, Standings], what: str
) -> Table:
    """Return how much stronger the first of every two conditions is.

    Parameters
    ----------
    contrasts : sequence of StrengthContrast
        Of one set.
    fitted : mapping of str to Standings
        What they are differences of, by question.
    what : str
        What those are called.
    """
    shared = any(_share_ranks(one, fitted[one.question]) for one in contrasts)
    return table("contrasts", contrasts, fitted=fitted, what=what, shared=shared)


def _share_ranks(one: StrengthContrast, fitted: Standings) -> bool:
    """Tell whether a decided difference is between conditions whose ranks overlap."""
    first, second = (
        {
            rank
            for c in fitted.conditions
            if c.condition == name and c.best and c.worst
            for rank in range(c.best, c.worst + 1)
        }
        for name in one.names
    )
    return one.p_holm < SIGNIFICANCE and bool(first & second)
