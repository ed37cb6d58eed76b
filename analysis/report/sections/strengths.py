"""Bradley-Terry strengths and Plackett-Luce worths as a figure and as tables."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from analysis.report import wording
from analysis.report.content import (
    PAIR,
    Picture,
    Table,
    interval_cell,
    number_cell,
    p_cell,
    table_of,
)
from analysis.report.figures.dots import Dot, dot_pictures
from analysis.report.figures.panels import Row
from analysis.report.figures.style import Scale
from analysis.report.figures.svg import About
from analysis.report.wording import (
    HOLM,
    INTERVAL,
    between,
    gathered,
    notes,
    number,
    place_of,
    ranks,
)
from analysis.results.strengths import StrengthContrast, Strengths, Worths
from analysis.stats.clustered_mean import LEVEL

Fitted = Strengths | Worths


def strength_pictures(found: Mapping[str, Fitted], axis: str, about: About) -> tuple[Picture, ...]:
    """Draw a panel per question and a row per condition, the strongest on the first one on top.

    Parameters
    ----------
    found : mapping of str to Strengths or Worths
        By question; those without a fit are left out, and without any nothing is drawn.
    axis : str
        What the values are.
    about : About
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
        about,
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


def standings_table(
    found: Mapping[str, Fitted], *, what: str, caption: str, name: str, data: str
) -> Table:
    """Return values, errors and ranks by question, the strongest condition first.

    Parameters
    ----------
    found : mapping of str to Strengths or Worths
        By question.
    what : str
        What the values are called.
    caption, name, data
        See `analysis.report.content.Table`.
    """
    return table_of(
        [
            (question, fitted, one, value)
            for question, fitted in found.items()
            for one, value in sorted(
                _values(fitted).items(), key=lambda pair: (math.isnan(pair[1]), -pair[1])
            )
        ],
        ("question", lambda row: wording.heading(row[0])),
        ("condition", lambda row: wording.condition(row[2])),
        (what, lambda row: number_cell(row[3])),
        ("error", lambda row: number_cell(_error(row[1], row[2]))),
        (INTERVAL, lambda row: interval_cell(row[1].low[row[2]], row[1].high[row[2]])),
        ("ranks", lambda row: ranks(row[1].ranks.get(row[2]))),
        caption=caption,
        notes=(
            note
            for question, fitted in found.items()
            for note in (
                *notes(fitted.reason, fitted.remark, wording.heading(question)),
                *notes(fitted.method and f"errors {fitted.method}", "", wording.heading(question)),
            )
        ),
        name=name,
        data=data,
    )


def _error(fitted: Fitted, name: str) -> float:
    error = fitted.errors_two_way[name]
    return fitted.errors[name] if math.isnan(error) else error


def _values(fitted: Fitted) -> Mapping[str, float]:
    return fitted.strengths if isinstance(fitted, Strengths) else fitted.worths


def contrasts_table(
    contrasts: Sequence[StrengthContrast],
    fitted: Mapping[str, Fitted],
    what: str,
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
    return table_of(
        contrasts,
        *PAIR,
        ("difference", lambda c: number_cell(c.estimate)),
        (INTERVAL, lambda c: interval_cell(c.low, c.high)),
        ("p", lambda c: p_cell(c.p_value)),
        (HOLM, lambda c: p_cell(c.p_holm)),
        caption=f"Differences of {what} of every two conditions, in "
        f"logits, with {LEVEL:.0%} intervals one at a time, clustered by participant and segment; "
        "above zero where the first is ahead. p is corrected by Holm over the report's family of "
        "tests. After exclusions.",
        notes=(
            *(
                f"{wording.heading(question)}, all conditions together: "
                + (
                    test.reason
                    or f"F({test.df:.0f}, {wording.quantity(test.df_rest)}) = "
                    f"{number(test.statistic)}, {wording.p_is(test.p_value)}; {test.method}"
                )
                + "."
                for question, model in fitted.items()
                for test in (model.omnibus,)
            ),
            *gathered(
                (place_of(one), note) for one in contrasts for note in (one.reason, one.remark)
            ),
            *((RANKS_ARE_WIDER,) if shared else ()),
        ),
        name="contrasts",
        data="contrasts.csv",
    )


RANKS_ARE_WIDER = (
    "Some differences are decided although both conditions may have the same rank: ranks hold for "
    "all conditions together at once (Bonferroni), while Holm's correction decides differences one "
    "after another, which finds more."
)


def _share_ranks(one: StrengthContrast, fitted: Fitted) -> bool:
    """Tell whether a decided difference is between conditions whose ranks overlap."""
    if not one.p_holm < 1 - LEVEL or not fitted.ranks:
        return False
    a, b = fitted.ranks[one.a], fitted.ranks[one.b]
    return a.best <= b.worst and b.best <= a.worst
