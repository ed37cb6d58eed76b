"""Estimates as marks with their intervals: a row each, and metrics beside people's preference."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from analysis.report import wording
from analysis.report.content import About, Picture
from analysis.report.figures.panels import Hints, Panel, PanelFigure, Row, panel_pictures
from analysis.report.figures.style import BLUE, LINE, PAPER, Scale, fitted, sign_of, write_beside
from analysis.results.against_people import MetricAgainstPeople, ScoredCondition
from analysis.stats.clustered_mean import Interval


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


def dot_of(
    found: Interval | None,
    written: Callable[[float], str],
    *,
    more: str = "",
    below: str = "",
    missing: str = "not known",
) -> Dot:
    """Return the mark of an estimate; all of it in words ends in `more`, or is `missing`."""
    if found is None or math.isnan(found.estimate):
        return Dot(words="–", hint=missing)
    inside = wording.interval(found, written) or f"no interval: {found.reason}"
    return Dot(
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        words=written(found.estimate),
        below=below,
        hint=f"{written(found.estimate)} {inside}{more}",
    )


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
    height = len(rows) * max(0.27, 0.13 * len(series) + 0.1) if series else 0.0
    return panel_pictures(
        PanelFigure(told=told, draw=draw, rows=rows, height=height, legend=_legend(series)), about
    )


def _legend(words: Sequence[str]) -> list[Line2D]:
    return [
        Line2D([], [], color=colour, marker=marker, linestyle="none", markersize=4.4, label=word)
        for word, (colour, marker) in ((w, sign_of(k)) for k, w in enumerate(words))
    ]


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


MOST: Final = 6
"""Panels of one figure: as many as stay readable on a page."""

_HEIGHT: Final = 1.25
_DIRECTIONS: Final = {
    "higher": "score{unit}, more is better →",
    "lower": "score{unit}, less is better →",
    "near the reference": "distance from recorded{unit} →",
}


def agreement_pictures(
    metrics: Sequence[MetricAgainstPeople],
    conditions: Sequence[str],
    preference: str,
    about: About,
) -> tuple[Picture, ...]:
    """Draw each metric against preference; where both agree, marks rise to the right.

    Parameters
    ----------
    metrics : sequence of MetricAgainstPeople
        At most `MOST`, each with at least one place.
    conditions : sequence of str
        All of them, each with a colour and a mark of its own.
    preference : str
        What the upright axis shows.
    about : About
        What stands around the figure.
    """
    by_name = {metric.metric: metric for metric in metrics}
    places = [place for metric in metrics for place in metric.places]
    ends = [v for p in places for v in (p.preference, p.low, p.high) if v == v]
    room = 0.09 * (max(ends) - min(ends)) or 0.5

    def draw(panel: Panel, name: str) -> Hints:
        (axes,), metric, hints = panel.axes, by_name[name], Hints()
        for row, place in enumerate(metric.places):
            (colour, marker), gid = (
                sign_of(conditions.index(place.condition)),
                f"{panel.prefix}-{row}",
            )
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
                gid=f"place{gid}",
            )
            hints[f"place{gid}"] = (
                f"{wording.condition(place.condition)}: {metric.metric} "
                f"{wording.quantity(place.score)}, preference {wording.fixed(place.preference, 2)}"
            )
        axes.margins(x=0.09)
        if metric.better != "higher":
            axes.invert_xaxis()
        axes.set_ylim(min(ends) - room, max(ends) + room)
        axes.locator_params(nbins=4, steps=(1, 2, 5, 10))
        axes.tick_params(labelsize=6.5, pad=1.5, length=2)
        axes.grid(color=LINE, linewidth=0.4)
        axes.set_axisbelow(True)
        unit = f" ({metric.unit})" if metric.unit else ""
        words = _DIRECTIONS[metric.better].format(unit=unit)
        axes.set_xlabel(fitted(words, panel.inches - 0.4, size=7), fontsize=7, labelpad=2)
        if panel.is_first:
            axes.set_ylabel(fitted(preference, _HEIGHT, size=7), fontsize=7, labelpad=2)
        return hints

    told = {
        metric.metric: f"{metric.metric}: "
        + ", ".join(
            f"{wording.condition(place.condition)} {wording.quantity(place.score)} with preference "
            f"{wording.fixed(place.preference, 2)}"
            for place in metric.places
        )
        + "."
        for metric in metrics
    }
    legend = _legend([wording.condition(name) for name in conditions])
    return panel_pictures(
        PanelFigure(told=told, draw=draw, height=_HEIGHT, columns=3, legend=legend), about
    )


def _shown_score(metric: MetricAgainstPeople, place: ScoredCondition) -> float:
    """Return what the level axis shows: the score, or its distance where nearness counts."""
    if metric.better == "near the reference":
        return abs(place.score - metric.recorded)
    return place.score
