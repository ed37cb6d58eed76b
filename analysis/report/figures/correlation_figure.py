"""Correlations of metrics with people's preference as a forest: a row per metric and question."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from analysis.report import wording
from analysis.report.content import Picture
from analysis.report.figures.ink import LINE, SERIES, STYLE
from analysis.report.figures.legend import draw_legend, legend_entries
from analysis.report.figures.panels import Scale, dress, numbered
from analysis.report.figures.sheet import Sheet, fitted
from analysis.report.figures.svg import WIDTH, picture
from analysis.results.against_people.result import (
    MetricAgainstPeople,
    RankCorrelation,
    WithinCorrelation,
)

Found = RankCorrelation | WithinCorrelation

_MARKS: Final = "osD^vP<>"
_NAMES: Final = 1.75
_GAP: Final = 0.2
_HEAD: Final = 0.28
_AXIS: Final = 0.45
_TALLEST: Final = 8.6
_STEP: Final = 0.13
"""Inches between the questions of one metric."""

_SCALE: Final = Scale(
    limits=(-1.05, 1.05),
    ticks={-1: "−1", -0.5: "−.5", 0: "0", 0.5: ".5", 1: "1"},
    ends=("disagrees", "agrees"),
    line=0.0,
)


def correlation_figure(
    questions: Mapping[str, Sequence[MetricAgainstPeople]],
    *,
    name: str,
    title: str,
    caption: str,
    data: str,
    mark: str,
) -> tuple[Picture, ...]:
    """Draw both correlations of every metric, on as many sheets as they need.

    Parameters
    ----------
    questions : mapping of str to sequence of MetricAgainstPeople
        By question.
    name, title, caption, data
        See `analysis.report.figures.svg.picture`.
    mark : str
        Written on top; empty for none.
    """
    metrics = list(dict.fromkeys(one.metric for own in questions.values() for one in own))
    height = max(0.27, _STEP * len(questions) + 0.1)
    entries = legend_entries([wording.heading(question) for question in questions])
    foot = _AXIS + entries.height
    per_sheet = max(1, int((_TALLEST - _HEAD - foot) // height))
    count = -(-len(metrics) // per_sheet)
    found = []
    for sheet_number, own_name in enumerate(numbered(name, count)):
        start, end = (len(metrics) * (sheet_number + k) // count for k in (0, 1))
        rows = {metric: row for row, metric in enumerate(metrics[start:end])}
        shown = {
            question: [one for one in own if one.metric in rows]
            for question, own in questions.items()
        }
        hints: dict[str, str] = {}
        with mpl.rc_context(STYLE):
            sheet = Sheet(_HEAD + (end - start) * height + foot, mark=mark)
            for metric, row in rows.items():
                sheet.write(
                    _NAMES - 0.1,
                    _HEAD + (row + 0.5) * height,
                    fitted(metric, _NAMES - 0.15, size=7.5, lines=2),
                    fontsize=7.5,
                    ha="right",
                    va="center",
                    linespacing=1.1,
                )
            width = (WIDTH - _NAMES - _GAP) / 2
            for panel, words in enumerate(
                ("Over conditions: Kendall's τ-b", "Within conditions: r")
            ):
                left = _NAMES + panel * (width + _GAP)
                sheet.write(left, _HEAD - 0.08, words, fontsize=8.5, fontweight="bold", va="bottom")
                axes = sheet.panel(left, _HEAD, width, (end - start) * height)
                hints |= _panel(axes, shown, rows, panel, height)
                dress(axes, end - start, _SCALE)
            signs = [
                Line2D(
                    [],
                    [],
                    color=_colour(k),
                    marker=_mark(k),
                    linestyle="none",
                    markersize=4.2,
                    label=w,
                )
                for k, w in enumerate(entries.words)
            ]
            draw_legend(sheet, signs, entries)
            found.append(
                picture(
                    sheet.figure,
                    name=own_name,
                    title=title,
                    alt=_alt(shown),
                    caption=caption,
                    data=data,
                    hints=hints,
                )
            )
    return tuple(found)


def correlation_words(found: Found) -> str:
    """Return a correlation with its interval where it has one, '.52 [.11, .79]'."""
    inside = interval_words(found)
    return f"{one_word(found.estimate)}{f' {inside}' if inside else ''}"


def interval_words(found: Found) -> str:
    """Return the interval; '' where there is none."""
    if math.isnan(found.low):
        return ""
    return f"[{one_word(found.low)},{wording.NO_BREAK}{one_word(found.high)}]"


def one_word(value: float) -> str:
    """Return a correlation as a share, '1' and '−1' without decimals."""
    if not math.isnan(value) and abs(value) > 0.995:
        return "1" if value > 0 else "−1"
    return wording.share(value)


def _panel(
    axes: Axes,
    questions: Mapping[str, Sequence[MetricAgainstPeople]],
    rows: Mapping[str, int],
    panel: int,
    height: float,
) -> dict[str, str]:
    hints = {}
    count = len(questions)
    for number, (question, metrics) in enumerate(questions.items()):
        shift = (number - (count - 1) / 2) * _STEP / height
        for metric in metrics:
            found = _of(metric, panel)
            if math.isnan(found.estimate):
                continue
            row = rows[metric.metric]
            at, gid = row + shift, f"r{panel}-{number}-{row}"
            if not math.isnan(found.low):
                axes.plot([found.low, found.high], [at, at], color=_colour(number), linewidth=1.1)
            axes.plot(
                [found.estimate],
                [at],
                marker=_mark(number),
                markersize=4.2,
                color=_colour(number),
                markerfacecolor=_colour(number) if not math.isnan(found.low) else "none",
                linestyle="none",
                gid=gid,
                clip_on=False,
            )
            hints[gid] = f"{wording.name(question)}, {metric.metric}: {correlation_words(found)}"
    for row in range(1, len(rows)):
        axes.axhline(row - 0.5, color=LINE, linewidth=0.4, zorder=0)
    return hints


def _of(metric: MetricAgainstPeople, panel: int) -> Found:
    return metric.within if panel else metric.kendall


def _colour(number: int) -> str:
    return SERIES[number % len(SERIES)]


def _mark(number: int) -> str:
    return _MARKS[number % len(_MARKS)]


def _alt(questions: Mapping[str, Sequence[MetricAgainstPeople]]) -> str:
    parts = [
        f"{wording.name(question)}, {metric.metric}: over conditions "
        f"{correlation_words(metric.kendall)}, within conditions {correlation_words(metric.within)}"
        for question, metrics in questions.items()
        for metric in metrics
    ]
    return f"Correlations of metrics with people's preference. {'; '.join(parts)}."
