"""Estimates with their intervals: next to bars of answers, as marks in rows, in matrices."""

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, TypeVar

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from analysis.report import wording
from analysis.report.content import FigureText, Picture
from analysis.report.figures.panels import Panel, PanelFigure, Row, panel_pictures
from analysis.report.figures.style import (
    BLUE,
    INK,
    LABEL_SIZE,
    LINE,
    PAPER,
    Scale,
    annotate_row,
    diverging_colour,
    series_style,
    text_colour,
)
from analysis.results.conditions import RankedCondition, RatedCondition
from analysis.stats.clustered_mean import Interval

ResultT = TypeVar("ResultT", RankedCondition, RatedCondition)

_ANNOTATION_WIDTH: Final = 0.76
"""Width of an estimate in words, in inches."""

_WIDTHS: Final = (0.73, 0.27)
"""Shares of a panel's width for its bars and its estimates."""

_NUMBERED_WIDTH: Final = 0.155
"""Smallest width of a part with a number in it, in inches."""


@dataclass(frozen=True, kw_only=True)
class Dot:
    """An estimate, drawn as a mark.

    Attributes
    ----------
    estimate, low, high : float
        The estimate and its interval; NaN if missing.
    words, below : str
        Text next to the mark: the estimate, and smaller text below it.
    in_full : str
        All of this in words, for readers who cannot see it.
    is_descriptive : bool
        Whether there are too few data for a test or an interval; the mark is hollow.
    is_overall : bool
        Whether it summarises the other rows; the mark is a diamond, below a line.
    """

    estimate: float = math.nan
    low: float = math.nan
    high: float = math.nan
    words: str = ""
    below: str = ""
    in_full: str = ""
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
    """Return the mark of an estimate; in full it ends in `more`, or is `missing` without one."""
    if interval is None or math.isnan(interval.estimate):
        return Dot(words="–", in_full=missing)
    words = formatted(interval.estimate)
    ends = wording.interval(interval, formatted) or f"no interval: {interval.reason}"
    return Dot(
        estimate=interval.estimate,
        low=interval.low,
        high=interval.high,
        words=words,
        below=below,
        in_full=f"{words} {ends}{more}",
    )


class Part(NamedTuple):
    """One part of a bar: its percentage, and the answers in words."""

    percent: float
    words: str


class Bar(NamedTuple):
    """A bar's parts, the first ones of the legend, an estimate next to it, and its left end."""

    parts: Sequence[Part] = ()
    dot: Dot = Dot()
    start: float = 0.0


def bar_of(
    parts: Iterable[Part],
    estimate: Interval,
    formatted: Callable[[float], str] = wording.number,
    start: float = 0.0,
) -> Bar:
    """Return a bar with its estimate in words."""
    ends = wording.interval(estimate, formatted) or "no interval"
    return Bar(tuple(parts), dot_of(estimate, formatted, below=ends), start)


def condition_bars(
    conditions: Sequence[ResultT], names: Collection[str], bar: Callable[[ResultT], Bar]
) -> tuple[dict[str, list[Bar]], list[Row]]:
    """Return the bars of conditions by question, and their rows, in the order of `names`."""
    by_name = {(c.condition, c.question): bar(c) for c in conditions if c.n}
    questions = dict.fromkeys(c.question for c in conditions)
    panels = {
        question: [by_name.get((name, question), Bar()) for name in names] for question in questions
    }
    counts = {name: max(c.n for c in conditions if c.condition == name) for name in names}
    return panels, [Row(wording.condition(name), f"n = {n}") for name, n in counts.items()]


def bar_pictures(
    panels: Mapping[str, Sequence[Bar]],
    rows: Sequence[Row],
    legend: Mapping[str, str],
    bar_scale: Scale,
    estimate_scale: Scale,
    text: FigureText,
) -> tuple[Picture, ...]:
    """Draw bars with estimates, on as many sheets as they need.

    Parameters
    ----------
    panels : mapping of str to sequence of Bar
        By question; every panel has as many bars as there are rows.
    rows : sequence of Row
        From the top.
    legend : mapping of str to str
        The names of the parts and their colours.
    bar_scale, estimate_scale : Scale
        The axes of both halves of a panel.
    text : FigureText
        The text around the figure.
    """

    def draw(panel: Panel, question: str) -> Iterator[str]:
        left, right = panel.axes
        inches = (panel.inches - _ANNOTATION_WIDTH) * _WIDTHS[0] - 0.1
        for number, (row, bar) in enumerate(zip(rows, panels[question], strict=True)):
            words = "no answers"
            _draw_bar(left, number, bar, [*legend.values()], bar_scale, inches)
            if bar.parts:
                _draw_dot(right, number, bar.dot, INK, "o")
                annotate_row(right, number, bar.dot.words, bar.dot.below, bold=True)
                parts = ", ".join(part.words for part in bar.parts)
                words = f"{parts}, {estimate_scale.label} {bar.dot.in_full}"
            yield f"{row.name}: {words}"
        bar_scale.apply(left, inches)
        estimate_scale.apply(right, inches)

    keys = [Patch(color=colour, label=name) for name, colour in legend.items()]
    return panel_pictures(
        PanelFigure(titles=[*panels], draw=draw, rows=rows, widths=_WIDTHS, legend=keys), text
    )


def _draw_bar(
    axes: Axes, row: int, bar: Bar, colours: Sequence[str], scale: Scale, inches: float
) -> None:
    low, high = scale.limits or (0.0, 100.0)
    if not bar.parts:
        axes.text((low + high) / 2, row, "no answers", ha="center", va="center", fontsize=7.5)
    left = bar.start
    for part, colour in zip(bar.parts, colours, strict=False):
        axes.barh(row, part.percent, left=left, height=0.66, color=colour)
        if part.percent / (high - low) * inches >= _NUMBERED_WIDTH:
            _write(axes, left + part.percent / 2, row, f"{part.percent:.0f}", colour, 7.0)
        left += part.percent


def _write(
    axes: Axes, x: float, y: float, text: str, background: str, size: float, *, bold: bool = False
) -> None:
    axes.text(
        x,
        y,
        text,
        ha="center",
        va="center_baseline",
        color=text_colour(background),
        fontsize=size,
        fontweight="bold" if bold else "normal",
    )


class MatrixCell(NamedTuple):
    """The win share of a row's condition, with its interval in words, and whether it differs."""

    share: float
    words: str
    is_significant: bool


def matrix_pictures(
    questions: Mapping[str, Mapping[tuple[str, str], MatrixCell]],
    conditions: Sequence[str],
    text: FigureText,
) -> tuple[Picture, ...]:
    """Draw a matrix per question: the share of the row's condition against the column's.

    Parameters
    ----------
    questions : mapping of str to mapping of (str, str) to MatrixCell
        By question, and then by the conditions of row and column.
    conditions : sequence of str
        The conditions of rows and columns, in order; columns have the numbers of the rows.
    text : FigureText
        The text around the figure.
    """
    count = len(conditions)

    def draw(panel: Panel, question: str) -> Iterator[str]:
        [axes] = panel.axes
        size = min(LABEL_SIZE, 24 * panel.inches / count)
        for spine in axes.spines.values():
            spine.set_visible(False)
        axes.set_xlim(-0.5, count - 0.5)
        axes.set_xticks(range(count), labels=[str(k + 1) for k in range(count)])
        axes.tick_params(axis="x", length=0, top=True, labeltop=True, labelbottom=False, pad=2)
        for row, condition in enumerate(conditions):
            axes.text(row, row, "–", ha="center", va="center", fontsize=size)
            for column, opponent in enumerate(conditions):
                cell = questions[question].get((condition, opponent))
                if cell is None:
                    continue
                colour = diverging_colour(1 - cell.share)
                axes.barh(row, 1, 1, left=column - 0.5, color=colour, edgecolor=PAPER)
                share = wording.share(cell.share)
                _write(axes, column, row, share, colour, size, bold=cell.is_significant)
                yield f"{wording.against(condition, opponent)}: {cell.words}"

    rows = [Row(f"{n} {wording.condition(name)}") for n, name in enumerate(conditions, start=1)]
    columns = 2 if count <= 6 else 1
    figure = PanelFigure(titles=[*questions], draw=draw, rows=rows, columns=columns)
    return panel_pictures(figure, text)


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
        The scale of every panel.
    text : FigureText
        The text around the figure.
    series : sequence of str, optional
        The names of several dots in a row.
    """
    dots_by_row = {
        title: [[row] if isinstance(row, Dot) else row for row in dots]
        for title, dots in panels.items()
    }

    def draw(panel: Panel, title: str) -> Iterator[str]:
        [axes] = panel.axes
        for number, (row, dots) in enumerate(zip(rows, dots_by_row[title], strict=True)):
            for index, dot in enumerate(dots):
                shift = (index - (len(dots) - 1) / 2) / (len(dots) + 1)
                colour, marker = series_style(index) if series else (BLUE, "o")
                _draw_dot(axes, number + shift, dot, colour, marker)
                annotate_row(axes, number, dot.words, dot.below)
                name = f"{row.name}, {series[index]}" if series else row.name
                yield f"{name}: {dot.in_full}"
            if number and (series or dots[0].is_overall):
                axes.axhline(number - 0.5, color=LINE, linewidth=0.7, zorder=0)
        scale.apply(axes, panel.inches)

    height = len(rows) * max(0.27, 0.13 * len(series) + 0.1) if series else 0.0
    legend = series_legend(series)
    return panel_pictures(
        PanelFigure(titles=[*panels], draw=draw, rows=rows, height=height, legend=legend), text
    )


def series_legend(names: Sequence[str]) -> list[Line2D]:
    """Return the keys of several conditions or questions."""
    return [
        Line2D([], [], color=colour, marker=marker, linestyle="none", markersize=4.4, label=name)
        for name, (colour, marker) in ((n, series_style(k)) for k, n in enumerate(names))
    ]


def _draw_dot(axes: Axes, y: float, dot: Dot, colour: str, marker: str) -> None:
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
        )
