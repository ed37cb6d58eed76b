"""Metrics beside people's preference: a small panel per metric, a mark per condition."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from matplotlib.lines import Line2D

from analysis.report import wording
from analysis.report.content import Picture
from analysis.report.figures.fitting import fitted
from analysis.report.figures.ink import LINE, PAPER, sign_of
from analysis.report.figures.panels import Hints, Panel, PanelFigure, panel_pictures
from analysis.report.figures.svg import About
from analysis.results.against_people.result import MetricAgainstPeople, Place

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
                f"{wording.name(place.condition)}: {metric.metric} "
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
            f"{wording.name(place.condition)} {wording.quantity(place.score)} with preference "
            f"{wording.fixed(place.preference, 2)}"
            for place in metric.places
        )
        + "."
        for metric in metrics
    }
    signs = [
        Line2D(
            [], [], color=c, marker=m, linestyle="none", markersize=4.5, label=wording.name(name)
        )
        for name, (c, m) in ((name, sign_of(k)) for k, name in enumerate(conditions))
    ]
    return panel_pictures(
        PanelFigure(told=told, draw=draw, height=_HEIGHT, columns=3, legend=signs), about
    )


def _shown_score(metric: MetricAgainstPeople, place: Place) -> float:
    """Return what the level axis shows: the score, or its distance where nearness counts."""
    if metric.better == "near the reference":
        return abs(place.score - metric.recorded)
    return place.score
