"""Estimates as marks with their intervals, in rows or as metrics against preference."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from analysis.report import wording
from analysis.report.content import FigureText, Picture
from analysis.report.figures.panels import Hints, Panel, PanelFigure, Row, panel_pictures
from analysis.report.figures.style import (
    BLUE,
    LINE,
    PAPER,
    Scale,
    annotate_row,
    fit_text,
    series_style,
)
from analysis.results.against_people import MetricAgainstPeople, ScoredCondition
from analysis.stats.clustered_mean import Interval


@dataclass(frozen=True, kw_only=True)
class Dot:
    """One estimate.

    Attributes
    ----------
    estimate, low, high : float
        NaN for none.
    words, below : str
        Written beside it: the estimate in words, and smaller words below them.
    hint : str
        All of it in words.
    is_descriptive : bool
        Whether it rests on too little for a test or an interval: its mark is hollow.
    is_overall : bool
        Whether it sums up the other rows: its mark is a diamond, below a line.
    """

    estimate: float = math.nan
    low: float = math.nan
    high: float = math.nan
    words: str = ""
    below: str = ""
    hint: str = ""
    is_descriptive: bool = False
    is_overall: bool = False


def dot_of(
    interval: Interval | None,
    formatted: Callable[[float], str],
    *,
    more: str = "",
    below: str = "",
    missing: str = "not known",
) -> Dot:
    """Return the mark of an estimate; its hint ends in `more`, or is `missing` for none."""
    if interval is None or math.isnan(interval.estimate):
        return Dot(words="–", hint=missing)
    words = formatted(interval.estimate)
    ends = wording.interval(interval, formatted) or f"no interval: {interval.reason}"
    return Dot(
        estimate=interval.estimate,
        low=interval.low,
        high=interval.high,
        words=words,
        below=below,
        hint=f"{words} {ends}{more}",
    )


def dot_pictures(
    panels: Mapping[str, Sequence[Dot | Sequence[Dot]]],
    rows: Sequence[Row],
    scale: Scale,
    text: FigureText,
    *,
    series: Sequence[str] = (),
) -> tuple[Picture, ...]:
    """Draw estimates in rows, on as many sheets as they need.

    Parameters
    ----------
    panels : mapping of str to sequence of Dot
        By the title of a panel; every panel has as many dots as there are rows, or as many
        sequences of dots, one dot for each of the `series`.
    rows : sequence of Row
        From the top.
    scale : Scale
        Of every panel.
    text : FigureText
        The text around the figure.
    series : sequence of str, optional
        The names of several dots in a row.
    """
    dots_by_row = {
        title: [[row] if isinstance(row, Dot) else row for row in dots]
        for title, dots in panels.items()
    }

    def draw(panel: Panel, title: str) -> Hints:
        axes, hints = panel.axes[0], Hints()
        for number, (row, dots) in enumerate(zip(rows, dots_by_row[title], strict=True)):
            for index, dot in enumerate(dots):
                gid = f"dot{panel.prefix}-{number}" + (f"-{index}" if series else "")
                shift = (index - (len(dots) - 1) / 2) / (len(dots) + 1)
                colour, marker = series_style(index) if series else (BLUE, "o")
                _draw_dot(axes, number + shift, dot, gid, colour, marker)
                hints[gid] = f"{_name(row, series, index)}: {dot.hint}"
                annotate_row(axes, number, dot.words, dot.below)
            if number and (series or dots[0].is_overall):
                axes.axhline(number - 0.5, color=LINE, linewidth=0.7, zorder=0)
        scale.apply(axes, panel.inches)
        return hints

    descriptions = {
        title: [
            f"{_name(row, series, index)}: {dot.hint}"
            for row, dots in zip(rows, all_dots, strict=True)
            for index, dot in enumerate(dots)
        ]
        for title, all_dots in dots_by_row.items()
    }
    height = len(rows) * max(0.27, 0.13 * len(series) + 0.1) if series else 0.0
    return panel_pictures(
        PanelFigure(
            descriptions=descriptions, draw=draw, rows=rows, height=height, legend=_legend(series)
        ),
        text,
    )


def _legend(names: Sequence[str]) -> list[Line2D]:
    return [
        Line2D([], [], color=colour, marker=marker, linestyle="none", markersize=4.4, label=name)
        for name, (colour, marker) in ((n, series_style(k)) for k, n in enumerate(names))
    ]


def _name(row: Row, series: Sequence[str], index: int) -> str:
    return f"{row.name}, {series[index]}" if series else row.name


def _draw_dot(axes: Axes, y: float, dot: Dot, gid: str, colour: str, marker: str) -> None:
    linewidth = 0.9 if dot.is_descriptive else 1.4
    axes.plot([dot.low, dot.high], [y] * 2, color=colour, linewidth=linewidth)
    if not math.isnan(dot.estimate):
        axes.plot(
            [dot.estimate],
            [y],
            marker="D" if dot.is_overall else marker,
            markersize=4.6,
            markerfacecolor=PAPER if dot.is_descriptive else colour,
            markeredgecolor=colour,
            linestyle="none",
            clip_on=False,
            gid=gid,
        )


MOST_METRICS: Final = 6
"""Metrics of one figure, as many as stay readable on a page."""

_HEIGHT: Final = 1.25
_AXIS_LABELS: Final = {
    "higher": "score{unit}, more is better →",
    "lower": "score{unit}, less is better →",
    "near the reference": "distance from recorded{unit} →",
}


def agreement_pictures(
    metrics: Sequence[MetricAgainstPeople],
    conditions: Sequence[str],
    preference: str,
    text: FigureText,
) -> tuple[Picture, ...]:
    """Draw each metric against preference; marks rise to the right where both agree.

    Parameters
    ----------
    metrics : sequence of MetricAgainstPeople
        At most `MOST_METRICS`, each with at least one place.
    conditions : sequence of str
        All of them; each has its own colour and marker.
    preference : str
        Label of the vertical axis.
    text : FigureText
        The text around the figure.
    """
    by_name = {metric.metric: metric for metric in metrics}
    places = [place for metric in metrics for place in metric.places]
    ends = [
        value for p in places for value in (p.preference, p.low, p.high) if not math.isnan(value)
    ]
    margin = 0.09 * (max(ends) - min(ends)) or 0.5

    def draw(panel: Panel, name: str) -> Hints:
        [axes], metric, hints = panel.axes, by_name[name], Hints()
        for number, place in enumerate(metric.places):
            colour, marker = series_style(conditions.index(place.condition))
            gid = f"place{panel.prefix}-{number}"
            score = _shown_score(metric, place)
            axes.plot([score] * 2, [place.low, place.high], color=colour, linewidth=1.1)
            axes.plot(
                [score],
                [place.preference],
                marker,
                markersize=5,
                color=colour,
                markeredgecolor=PAPER,
                markeredgewidth=0.5,
                gid=gid,
            )
            hints[gid] = (
                f"{wording.condition(place.condition)}: {metric.metric} "
                f"{wording.quantity(place.score)}, preference {wording.number(place.preference)}"
            )
        axes.margins(x=0.09)
        if metric.better != "higher":
            axes.invert_xaxis()
        axes.set_ylim(min(ends) - margin, max(ends) + margin)
        axes.locator_params(nbins=4, steps=(1, 2, 5, 10))
        axes.tick_params(labelsize=6.5, pad=1.5, length=2)
        axes.grid(color=LINE, linewidth=0.4)
        axes.set_axisbelow(True)
        unit = f" ({metric.unit})" if metric.unit else ""
        label = _AXIS_LABELS[metric.better].format(unit=unit)
        axes.set_xlabel(fit_text(label, panel.inches - 0.4, size=7), fontsize=7, labelpad=2)
        if panel.is_first:
            axes.set_ylabel(fit_text(preference, _HEIGHT, size=7), fontsize=7, labelpad=2)
        return hints

    descriptions = {
        metric.metric: [
            f"{wording.condition(place.condition)} {wording.quantity(place.score)} with preference "
            f"{wording.number(place.preference)}"
            for place in metric.places
        ]
        for metric in metrics
    }
    legend = _legend([wording.condition(name) for name in conditions])
    return panel_pictures(
        PanelFigure(descriptions=descriptions, draw=draw, height=_HEIGHT, columns=3, legend=legend),
        text,
    )


def _shown_score(metric: MetricAgainstPeople, place: ScoredCondition) -> float:
    """Return the score, or its distance from that of recorded motion if nearness counts."""
    if metric.better == "near the reference":
        return abs(place.score - metric.recorded)
    return place.score
