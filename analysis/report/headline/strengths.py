"""Bradley-Terry strengths and Plackett-Luce worths as a figure and as tables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from analysis.report import wording
from analysis.report.content import Cell, Picture, Table, cells
from analysis.report.figures.dots import Dot, dot_pictures
from analysis.report.figures.panels import Row, Scale
from analysis.report.figures.svg import About
from analysis.report.headline.words import (
    between,
    gathered,
    interval_cell,
    notes,
    number,
    number_cell,
    of_set,
    p_cell,
    ranks,
)
from analysis.results.strengths import StrengthContrast, Strengths, Worths
from analysis.stats.clustered_mean import LEVEL

Fitted = Strengths | Worths


@dataclass(frozen=True, kw_only=True)
class Standing:
    """Where one condition stands.

    Attributes
    ----------
    condition : str
        Its name.
    value, low, high : float
        On a log scale on which all conditions add up to zero, with its interval.
    ranks : str
        Those it may have, '1–2'.
    """

    condition: str
    value: float
    low: float
    high: float
    ranks: str


def strength_pictures(
    standings: Mapping[str, Sequence[Standing]], axis: str, about: About
) -> tuple[Picture, ...]:
    """Draw a panel per question and a row per condition, the strongest on the first one on top.

    Parameters
    ----------
    standings : mapping of str to sequence of Standing
        By question; nothing is drawn without any.
    axis : str
        What the values are.
    about : About
        What stands around the figure.
    """
    if not standings:
        return ()
    first = next(iter(standings.values()))
    values = {one.condition: one.value for one in first if not math.isnan(one.value)}
    names = dict.fromkeys(one.condition for found in standings.values() for one in found)
    order = sorted(names, key=lambda one: -values.get(one, -math.inf))
    panels = {}
    for question, found in standings.items():
        by_name = {one.condition: one for one in found}
        panels[question] = [_dot(by_name.get(name)) for name in order]
    rows = [Row(wording.name(one)) for one in order]
    return dot_pictures(panels, rows, Scale(label=axis, line=0.0), about)


def _dot(one: Standing | None) -> Dot:
    if one is None or math.isnan(one.value):
        return Dot(words="–", hint="not known")
    inside = "" if math.isnan(one.low) else f" {between(number(one.low), number(one.high))}"
    return Dot(
        estimate=one.value,
        low=one.low,
        high=one.high,
        words=number(one.value),
        below=f"rank {one.ranks}" if one.ranks != "–" else "",
        hint=f"{number(one.value)}{inside}, rank {one.ranks}",
    )


def standings(fitted: Fitted) -> tuple[Standing, ...]:
    """Return where each condition stands; () where the model could not be fitted."""
    values = _values(fitted)
    if fitted.reason or not values:
        return ()
    return tuple(
        Standing(
            condition=name,
            value=value,
            low=fitted.low[name],
            high=fitted.high[name],
            ranks=ranks(fitted.ranks.get(name)),
        )
        for name, value in values.items()
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
    rows = [
        (
            *cells(wording.heading(question), wording.name(one)),
            number_cell(value),
            *_uncertainty(fitted, one),
            Cell(text=ranks(fitted.ranks.get(one))),
        )
        for question, fitted in found.items()
        for one, value in sorted(
            _values(fitted).items(), key=lambda pair: (math.isnan(pair[1]), -pair[1])
        )
    ]
    return Table(
        caption=caption,
        header=("question", "condition", what, "error", f"{LEVEL:.0%} interval", "ranks"),
        rows=tuple(rows),
        text_columns=2,
        notes=tuple(
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


def _uncertainty(fitted: Fitted, name: str) -> tuple[Cell, Cell]:
    error = fitted.errors_two_way[name]
    if math.isnan(error):
        error = fitted.errors[name]
    return number_cell(error), interval_cell(fitted.low[name], fitted.high[name])


def _values(fitted: Fitted) -> Mapping[str, float]:
    return fitted.strengths if isinstance(fitted, Strengths) else fitted.worths


def contrasts_table(
    contrasts: Sequence[StrengthContrast],
    fitted: Mapping[str, Fitted],
    what: str,
    *,
    name: str,
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
    name : str
        See `analysis.report.content.Table`.
    """
    shared = any(_share_ranks(one, fitted[one.question]) for one in contrasts)
    return Table(
        caption=f"{of_set(contrasts[0].set)}Differences of {what} of every two conditions, in "
        f"logits, with {LEVEL:.0%} intervals one at a time, clustered by participant and segment; "
        "above zero where the first is ahead. p is corrected by Holm over the report's family of "
        "tests. After exclusions.",
        header=(
            *("question", "first", "second", "difference", f"{LEVEL:.0%} interval"),
            *("p", f"p{wording.NO_BREAK}(Holm)"),
        ),
        rows=tuple(
            (
                *cells(wording.heading(one.question), wording.name(one.a), wording.name(one.b)),
                number_cell(one.estimate),
                interval_cell(one.low, one.high),
                p_cell(one.p_value),
                p_cell(one.p_holm),
            )
            for one in contrasts
        ),
        text_columns=3,
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
                (
                    f"{wording.heading(one.question)}, {wording.name(one.a)} against "
                    f"{wording.name(one.b)}",
                    note,
                )
                for one in contrasts
                for note in (one.reason, one.remark)
            ),
            *((RANKS_ARE_WIDER,) if shared else ()),
        ),
        name=name,
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
