"""Answers as stacked bars with an estimate and its interval beside each."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from matplotlib.axes import Axes
from matplotlib.patches import Patch

from analysis.report.content import Picture
from analysis.report.figures.ink import INK, on
from analysis.report.figures.panel_figure import PanelFigure, panel_pictures
from analysis.report.figures.panels import Place, RowName, Scale, dress, write_beside
from analysis.report.figures.sheet import Sheet

_ESTIMATE_SHARE: Final = 0.22
"""Share of a panel in which estimates stand."""

_WORDS: Final = 0.76
"""Room for an estimate in words, in inches."""

_GAP: Final = 0.14
"""Between a panel's bars and its estimates, in inches."""

_NARROWEST: Final = 0.155
"""Inches that a part must span to carry its number."""


@dataclass(frozen=True, kw_only=True)
class Part:
    """One part of a bar: how many percent, and what a reader sees who points at it."""

    percent: float
    hint: str


@dataclass(frozen=True, kw_only=True)
class Bar:
    """One row of a panel.

    Attributes
    ----------
    start : float
        Where it begins, in percent.
    parts : tuple of Part
        In the order of the legend; () where there are no answers.
    estimate, low, high : float
        NaN where there is none.
    words, below : str
        The estimate in words, and its interval.
    """

    start: float
    parts: tuple[Part, ...]
    estimate: float = math.nan
    low: float = math.nan
    high: float = math.nan
    words: str = ""
    below: str = ""


@dataclass(frozen=True, kw_only=True)
class BarFigure:
    """Everything that the figure shows.

    Attributes
    ----------
    panels : mapping of str to tuple of Bar
        By question; every panel has as many bars as there are rows.
    told : mapping of str to str
        By question, what its panel shows in words, with the numbers.
    rows : tuple of RowName
        From the top.
    colours, legend : tuple of str
        Of the parts.
    bars, estimates : Scale
        The axes of both halves of a panel.
    """

    panels: Mapping[str, tuple[Bar, ...]]
    told: Mapping[str, str]
    rows: tuple[RowName, ...]
    colours: tuple[str, ...]
    legend: tuple[str, ...]
    bars: Scale
    estimates: Scale


def bar_pictures(
    figure: BarFigure, *, name: str, title: str, caption: str, data: str, mark: str
) -> tuple[Picture, ...]:
    """Draw a figure on as many sheets as it needs; see `analysis.report.figures.svg.picture`."""

    def signs(words: Sequence[str]) -> list[Patch]:
        return [Patch(color=c, label=word) for c, word in zip(figure.colours, words, strict=True)]

    return panel_pictures(
        PanelFigure(
            told=figure.told,
            rows=figure.rows,
            draw=lambda sheet, place, question: _panel(
                sheet, place, figure, figure.panels[question]
            ),
            legend=figure.legend,
            signs=signs,
        ),
        name=name,
        title=title,
        caption=caption,
        data=data,
        mark=mark,
    )


def _panel(sheet: Sheet, place: Place, figure: BarFigure, bars: Sequence[Bar]) -> dict[str, str]:
    beside = place.width * _ESTIMATE_SHARE
    wide = place.width - beside - _WORDS - _GAP
    left = sheet.panel(place.left, place.top, wide, place.height)
    right = sheet.panel(place.left + wide + _GAP, place.top, beside, place.height)
    hints: dict[str, str] = {}
    for row, bar in enumerate(bars):
        hints |= _bar(left, row, bar, figure, f"bar{place.number}-{row}", wide)
        _estimate(right, row, bar)
    for axes, scale in ((left, figure.bars), (right, figure.estimates)):
        dress(axes, len(bars), scale)
    return hints


def _bar(
    axes: Axes, row: int, bar: Bar, figure: BarFigure, gid: str, inches: float
) -> dict[str, str]:
    """Draw one bar; return the hover text of its parts."""
    low, high = figure.bars.limits
    if not bar.parts:
        axes.text((low + high) / 2, row, "no answers", ha="center", va="center", fontsize=7.5)
        return {}
    hints: dict[str, str] = {}
    left = bar.start
    for level, part in enumerate(bar.parts):
        colour = figure.colours[level]
        patch = axes.barh(row, part.percent, left=left, height=0.66, color=colour)[0]
        patch.set_gid(f"{gid}-{level}")
        hints[f"{gid}-{level}"] = part.hint
        if part.percent / (high - low) * inches >= _NARROWEST:
            axes.text(
                left + part.percent / 2,
                row,
                f"{part.percent:.0f}",
                ha="center",
                va="center_baseline",
                color=on(colour),
                fontsize=7.0,
            )
        left += part.percent
    return hints


def _estimate(axes: Axes, row: int, bar: Bar) -> None:
    if not math.isnan(bar.low):
        axes.plot([bar.low, bar.high], [row, row], color=INK, linewidth=1.3, solid_capstyle="butt")
    if not math.isnan(bar.estimate):
        axes.plot([bar.estimate], [row], marker="o", markersize=4.2, color=INK, clip_on=False)
    write_beside(axes, row, bar.words, bar.below, bold=True)
