"""Metrics beside people's preference: a small panel per metric, a mark per condition."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from analysis.report import wording
from analysis.report.content import Picture
from analysis.report.figures.dot_figure import round_ticks
from analysis.report.figures.ink import INK, LINE, PAPER, SERIES, STYLE
from analysis.report.figures.legend import draw_legend, legend_entries
from analysis.report.figures.sheet import Sheet, fitted
from analysis.report.figures.svg import WIDTH, picture
from analysis.results.against_people.result import MetricAgainstPeople, Place

MARKS: Final = "osD^vP<>Xhp*"
COLUMNS: Final = 3
MOST: Final = 6
"""Panels of one figure: as many as stay readable on a page."""

_LEFT: Final = 0.42
_GAP: Final = 0.38
_HEAD: Final = 0.36
_HEIGHT: Final = 1.25
_FOOT: Final = 0.42


def agreement_figure(
    metrics: Sequence[MetricAgainstPeople],
    conditions: Sequence[str],
    *,
    preference: str,
    name: str,
    title: str,
    caption: str,
    data: str,
    mark: str,
) -> Picture:
    """Draw each metric against preference; where both agree, marks rise to the right.

    Parameters
    ----------
    metrics : sequence of MetricAgainstPeople
        At most `MOST`, each with at least one place.
    conditions : sequence of str
        All of them, each with a colour and a mark of its own.
    preference : str
        What the upright axis shows.
    name, title, caption, data
        See `analysis.report.figures.svg.picture`.
    mark : str
        Written on top; empty for none.
    """
    looks = {
        condition: (SERIES[place % len(SERIES)], MARKS[place % len(MARKS)])
        for place, condition in enumerate(conditions)
    }
    entries = legend_entries([wording.name(condition) for condition in conditions])
    lines = -(-len(metrics) // COLUMNS)
    line = _HEAD + _HEIGHT + _FOOT
    width = (WIDTH - _LEFT - (COLUMNS - 1) * _GAP) / COLUMNS
    hints: dict[str, str] = {}
    reach = _reach([place for metric in metrics for place in metric.places])
    with mpl.rc_context(STYLE):
        sheet = Sheet(lines * line + 0.1 + entries.height, mark=mark)
        for number, metric in enumerate(metrics):
            left = _LEFT + (number % COLUMNS) * (width + _GAP)
            top = (number // COLUMNS) * line + _HEAD
            sheet.write(
                left,
                top - 0.06,
                fitted(metric.metric, width, size=8, lines=2, bold=True),
                fontsize=8,
                fontweight="bold",
                va="bottom",
                linespacing=1.1,
            )
            axes = sheet.panel(left, top, width, _HEIGHT)
            hints |= _panel(axes, metric, looks, number)
            _dress(axes, metric, reach, width, labelled=number % COLUMNS == 0, words=preference)
        signs = [
            Line2D([], [], color=colour, marker=sign, linestyle="none", markersize=4.5, label=text)
            for (colour, sign), text in zip(looks.values(), entries.words, strict=True)
        ]
        draw_legend(sheet, signs, entries)
        return picture(
            sheet.figure,
            name=name,
            title=title,
            alt=_alt(metrics, preference),
            caption=caption,
            data=data,
            hints=hints,
        )


def shown_score(metric: MetricAgainstPeople, place: Place) -> float:
    """Return what the level axis shows: the score, or its distance where nearness counts."""
    if metric.better == "near the reference":
        return abs(place.score - metric.recorded)
    return place.score


def _panel(
    axes: Axes, metric: MetricAgainstPeople, looks: Mapping[str, tuple[str, str]], number: int
) -> dict[str, str]:
    hints = {}
    for row, place in enumerate(metric.places):
        colour, sign = looks[place.condition]
        score = shown_score(metric, place)
        if not math.isnan(place.low):
            axes.plot([score, score], [place.low, place.high], color=colour, linewidth=1.1)
        gid = f"place{number}-{row}"
        axes.plot(
            [score],
            [place.preference],
            marker=sign,
            markersize=5,
            color=colour,
            markeredgecolor=PAPER,
            markeredgewidth=0.5,
            linestyle="none",
            gid=gid,
        )
        hints[gid] = (
            f"{wording.name(place.condition)}: {metric.metric} {wording.quantity(place.score)}, "
            f"preference {wording.fixed(place.preference, 2)}"
        )
    return hints


def _dress(
    axes: Axes,
    metric: MetricAgainstPeople,
    reach: tuple[float, float],
    width: float,
    *,
    labelled: bool,
    words: str,
) -> None:
    scores = np.array([shown_score(metric, place) for place in metric.places])
    low, high = _widened(float(scores.min()), float(scores.max()))
    axes.set_xlim(*((low, high) if metric.better == "higher" else (high, low)))
    axes.set_ylim(*reach)
    ticks = round_ticks((low, high), most=4)
    axes.set_xticks(list(ticks), labels=list(ticks.values()))
    ticks = round_ticks(reach, most=4)
    axes.set_yticks(list(ticks), labels=list(ticks.values()))
    axes.tick_params(labelsize=6.5, pad=1.5, length=2)
    axes.grid(color=LINE, linewidth=0.4)
    axes.set_axisbelow(True)
    unit = f" ({metric.unit})" if metric.unit else ""
    what = {
        "higher": f"score{unit}, more is better →",
        "lower": f"score{unit}, less is better →",
        "near the reference": f"distance from recorded{unit} →",
    }[metric.better]
    axes.set_xlabel(fitted(what, width, size=7), fontsize=7, labelpad=2, color=INK)
    if labelled:
        axes.set_ylabel(fitted(words, _HEIGHT, size=7), fontsize=7, labelpad=2, color=INK)


def _reach(places: Sequence[Place]) -> tuple[float, float]:
    values = [v for p in places for v in (p.preference, p.low, p.high) if math.isfinite(v)]
    return _widened(min(values, default=0.0), max(values, default=1.0))


def _widened(low: float, high: float) -> tuple[float, float]:
    room = 0.09 * (high - low) or 0.1 * abs(high) or 0.5
    return low - room, high + room


def _alt(metrics: Sequence[MetricAgainstPeople], preference: str) -> str:
    parts = [
        f"{metric.metric}: "
        + ", ".join(
            f"{wording.name(place.condition)} {wording.quantity(place.score)} with preference "
            f"{wording.fixed(place.preference, 2)}"
            for place in metric.places
        )
        for metric in metrics
    ]
    return f"Scatter plots of metrics against people's {preference}. {'; '.join(parts)}."
