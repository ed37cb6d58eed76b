"""Bradley-Terry strengths and Plackett-Luce worths as a figure and a table."""

from __future__ import annotations

import math
from collections.abc import Mapping

from analysis.preferences.clustered import LEVEL
from analysis.report import wording
from analysis.report.content import Cell, Table, cells
from analysis.report.headline.strength_figure import Standing
from analysis.report.headline.words import between, counted, notes, number, ranks
from analysis.results.strengths import Strengths
from analysis.results.worths import Worths

Fitted = Strengths | Worths


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
            counted(value, number(value)),
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
    low, high = fitted.low[name], fitted.high[name]
    inside = "–" if math.isnan(low) else between(number(low), number(high))
    return counted(error, number(error)), counted(low, inside)


def _values(fitted: Fitted) -> Mapping[str, float]:
    return fitted.strengths if isinstance(fitted, Strengths) else fitted.worths
