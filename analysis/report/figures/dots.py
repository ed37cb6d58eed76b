"""Estimates as dots on their intervals, a row each: strengths, worths, correlations, forests."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from analysis.report import wording
from analysis.report.content import Picture
from analysis.report.figures.ink import BLUE, LINE, PAPER, sign_of
from analysis.report.figures.panels import (
    Hints,
    Panel,
    PanelFigure,
    Row,
    Scale,
    panel_pictures,
    write_beside,
)
from analysis.report.figures.svg import About


@dataclass(frozen=True, kw_only=True)
class Dot:
    """One estimate.

    Attributes
    ----------
    estimate, low, high : float
        NaN where there is none.
    words, below : str
        The estimate in words, and what stands under them; '' where nothing stands beside it.
    hint : str
        All of it in words.
    descriptive : bool
        Whether it rests on too little for a test or an interval: its mark is hollow.
    whole : bool
        Whether it is about everything that the other rows are parts of: its mark is a diamond,
        and a line sets it off.
    """

    estimate: float = math.nan
    low: float = math.nan
    high: float = math.nan
    words: str = ""
    below: str = ""
    hint: str = ""
    descriptive: bool = False
    whole: bool = False


def dot_pictures(
    panels: Mapping[str, Sequence[Dot | Sequence[Dot]]],
    rows: Sequence[Row],
    scale: Scale,
    about: About,
    *,
    series: Sequence[str] = (),
) -> tuple[Picture, ...]:
    """Draw a figure on as many sheets as it needs.

    Parameters
    ----------
    panels : mapping of str to sequence of Dot
        By question, or whatever else heads a panel; every panel has as many dots as there are
        rows, or as many sequences of dots, one dot for each of the `series`.
    rows : sequence of Row
        From the top.
    scale : Scale
        Of every panel.
    about : About
        What stands around the figure.
    series : sequence of str, optional
        What several dots of a row are called.
    """
    dots = {
        question: [[one] if isinstance(one, Dot) else one for one in own]
        for question, own in panels.items()
    }

    def draw(panel: Panel, question: str) -> Hints:
        axes, hints = panel.axes[0], Hints()
        for number, (row, own) in enumerate(zip(rows, dots[question], strict=True)):
            for place, dot in enumerate(own):
                gid = f"dot{panel.prefix}-{number}" + (f"-{place}" if series else "")
                shift = (place - (len(own) - 1) / 2) / (len(own) + 1)
                colour, marker = sign_of(place) if series else (BLUE, "o")
                _draw(axes, number + shift, dot, gid, colour, marker)
                hints[gid] = f"{_name(row, series, place)}: {dot.hint}"
                write_beside(axes, number, dot.words, dot.below)
            if number and (series or own[0].whole):
                axes.axhline(number - 0.5, color=LINE, linewidth=0.7, zorder=0)
        scale.dress(axes, panel.inches)
        return hints

    told = {
        question: f"{wording.heading(question)}. "
        + "; ".join(
            f"{_name(row, series, place)}: {dot.hint}"
            for row, found in zip(rows, own, strict=True)
            for place, dot in enumerate(found)
        )
        + "."
        for question, own in dots.items()
    }
    signs = [
        Line2D([], [], color=colour, marker=marker, linestyle="none", markersize=4.2, label=word)
        for word, (colour, marker) in ((w, sign_of(k)) for k, w in enumerate(series))
    ]
    height = len(rows) * max(0.27, 0.13 * len(series) + 0.1) if series else 0.0
    return panel_pictures(
        PanelFigure(told=told, draw=draw, rows=rows, height=height, legend=signs), about
    )


def _name(row: Row, series: Sequence[str], place: int) -> str:
    return f"{row.name}, {series[place]}" if series else row.name


def _draw(axes: Axes, row: float, dot: Dot, gid: str, colour: str, marker: str) -> None:
    wide = 0.9 if dot.descriptive else 1.4
    axes.plot([dot.low, dot.high], [row] * 2, color=colour, linewidth=wide)
    if not math.isnan(dot.estimate):
        axes.plot(
            [dot.estimate],
            [row],
            marker="D" if dot.whole else marker,
            markersize=4.6,
            markerfacecolor=PAPER if dot.descriptive else colour,
            markeredgecolor=colour,
            linestyle="none",
            clip_on=False,
            gid=gid,
        )
