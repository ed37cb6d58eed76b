"""Estimates as dots on their intervals, a row each: strengths, worths, forests."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from matplotlib.axes import Axes

from analysis.report.content import Picture
from analysis.report.figures.ink import BLUE, LINE, PAPER
from analysis.report.figures.panel_figure import PanelFigure, panel_pictures
from analysis.report.figures.panels import Place, RowName, Scale, dress, write_beside
from analysis.report.figures.sheet import Sheet

_WORDS: Final = 0.8
"""Room for an estimate in words, in inches."""


@dataclass(frozen=True, kw_only=True)
class Dot:
    """One row of a panel.

    Attributes
    ----------
    estimate, low, high : float
        NaN where there is none.
    words, below : str
        The estimate in words, and what stands under them.
    hint : str
        What a reader sees who points at it.
    descriptive : bool
        Whether it rests on too little for a test: its mark is hollow.
    whole : bool
        Whether it is about everything that the other rows are parts of: its mark is a diamond,
        and a line sets it off.
    """

    estimate: float
    low: float = math.nan
    high: float = math.nan
    words: str = ""
    below: str = ""
    hint: str = ""
    descriptive: bool = False
    whole: bool = False


def dot_pictures(
    panels: Mapping[str, Sequence[Dot]],
    rows: Sequence[RowName],
    scale: Scale,
    *,
    name: str,
    title: str,
    told: Mapping[str, str],
    caption: str,
    data: str,
    mark: str,
) -> tuple[Picture, ...]:
    """Draw a figure on as many sheets as it needs.

    Parameters
    ----------
    panels : mapping of str to sequence of Dot
        By question, or whatever else heads a panel; every panel has as many dots as there are rows.
    rows : sequence of RowName
        From the top.
    scale : Scale
        Of every panel.
    name, title, caption, data
        See `analysis.report.figures.svg.picture`.
    told : mapping of str to str
        By question, what its panel shows in words, with the numbers.
    mark : str
        Written on top; empty for none.
    """
    return panel_pictures(
        PanelFigure(
            told=told,
            rows=tuple(rows),
            draw=lambda sheet, place, question: _panel(sheet, place, panels[question], scale),
        ),
        name=name,
        title=title,
        caption=caption,
        data=data,
        mark=mark,
    )


def spread(dots: Sequence[Dot], *, around: float | None = None) -> tuple[float, float]:
    """Return how far an axis must go to hold all dots, their intervals, and `around`."""
    values = [value for dot in dots for value in (dot.estimate, dot.low, dot.high)]
    values = [value for value in values if math.isfinite(value)]
    values += [] if around is None else [around]
    low, high = min(values, default=0.0), max(values, default=1.0)
    room = 0.06 * (high - low) or 0.5
    return low - room, high + room


def round_ticks(limits: tuple[float, float], *, most: int = 5) -> dict[float, str]:
    """Return at most so many round numbers within an axis, and how they are written."""
    wide = limits[1] - limits[0]
    step = 10.0 ** math.floor(math.log10(wide / most))
    step = next(step * k for k in (1, 2, 5, 10) if wide / (step * k) <= most + 1e-6)
    places = max(0, -math.floor(math.log10(step)))
    first = math.ceil(limits[0] / step - 1e-6)
    found = {}
    for number in range(first, math.floor(limits[1] / step + 1e-6) + 1):
        value = round(number * step, 10)
        found[value] = f"{value:.{places}f}".replace("-", "−")
    return found


def _panel(sheet: Sheet, place: Place, dots: Sequence[Dot], scale: Scale) -> dict[str, str]:
    axes = sheet.panel(place.left, place.top, place.width - _WORDS, place.height)
    hints: dict[str, str] = {}
    for row, dot in enumerate(dots):
        gid = f"dot{place.number}-{row}"
        _dot(axes, row, dot, gid)
        if dot.hint:
            hints[gid] = dot.hint
        if dot.whole and row:
            axes.axhline(row - 0.5, color=LINE, linewidth=0.7)
    dress(axes, len(dots), scale)
    return hints


def _dot(axes: Axes, row: int, dot: Dot, gid: str) -> None:
    if not math.isnan(dot.low):
        axes.plot(
            [dot.low, dot.high],
            [row, row],
            color=BLUE,
            linewidth=0.9 if dot.descriptive else 1.4,
            solid_capstyle="butt",
        )
    if not math.isnan(dot.estimate):
        axes.plot(
            [dot.estimate],
            [row],
            marker="D" if dot.whole else "o",
            markersize=4.6,
            markerfacecolor=PAPER if dot.descriptive else BLUE,
            markeredgecolor=BLUE,
            linestyle="none",
            clip_on=False,
            gid=gid,
        )
    write_beside(axes, row, dot.words, dot.below)
