"""Bars of coloured parts: answers with an estimate and its interval beside each, and matrices."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, NamedTuple

from matplotlib.axes import Axes
from matplotlib.patches import Patch

from analysis.report import wording
from analysis.report.content import About, Picture
from analysis.report.figures.panels import Hints, Panel, PanelFigure, Row, panel_pictures
from analysis.report.figures.style import (
    INK,
    LABEL_SIZE,
    PAPER,
    Scale,
    between_sides,
    on,
    write_beside,
)
from analysis.stats.clustered_mean import Estimate

_WORDS: Final = 0.76
"""Room for an estimate in words, in inches."""

_WIDTHS: Final = (0.73, 0.27)
"""Shares of a panel's width in which its bars and its estimates stand."""

_NARROWEST: Final = 0.155
"""Inches that a part must span to carry its number."""


class Part(NamedTuple):
    """One part of a bar: how many percent, its colour, and what a reader sees who points at it."""

    percent: float
    colour: str
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
    beside : Estimate
        What stands beside it, with its interval.
    written : callable
        Writes numbers of `beside`.
    """

    start: float = 0.0
    parts: tuple[Part, ...] = ()
    beside: Estimate = field(default_factory=Estimate)
    written: Callable[[float], str] = wording.number

    @property
    def words(self) -> str:
        """The estimate in words; '' without answers."""
        return self.written(self.beside.estimate) if self.parts else ""

    @property
    def below(self) -> str:
        """Its interval, or that it has none; '' without answers."""
        inside = wording.interval(self.beside, self.written) or "no interval"
        return inside if self.parts else ""


def bar_pictures(
    panels: Mapping[str, Sequence[Bar]],
    rows: Sequence[Row],
    legend: Mapping[str, str],
    bars: Scale,
    estimates: Scale,
    about: About,
) -> tuple[Picture, ...]:
    """Draw a figure on as many sheets as it needs.

    Parameters
    ----------
    panels : mapping of str to sequence of Bar
        By question; every panel has as many bars as there are rows.
    rows : sequence of Row
        From the top.
    legend : mapping of str to str
        What the parts are called, and their colours.
    bars, estimates : Scale
        The axes of both halves of a panel.
    about : About
        What stands around the figure.
    """

    def draw(panel: Panel, question: str) -> Hints:
        left, right = panel.axes
        inches = (panel.inches - _WORDS) * _WIDTHS[0] - 0.1
        hints: Hints = {}
        for number, (row, bar) in enumerate(zip(rows, panels[question], strict=True)):
            parts = _draw_parts(left, number, bar, bars, f"bar{panel.prefix}-{number}", inches)
            hints |= {gid: f"{row.name}, {hint}" for gid, hint in parts.items()}
            found = bar.beside
            right.plot([found.low, found.high], [number] * 2, color=INK, linewidth=1.3)
            right.plot([found.estimate], [number], "o", markersize=4.2, color=INK, clip_on=False)
            write_beside(right, number, bar.words, bar.below, bold=True)
        bars.dress(left, inches)
        estimates.dress(right, inches)
        return hints

    told = {
        question: f"{wording.heading(question)}. "
        + " ".join(
            _tell(row.name, bar, estimates.label) for row, bar in zip(rows, own, strict=True)
        )
        for question, own in panels.items()
    }
    signs = [Patch(color=colour, label=word) for word, colour in legend.items()]
    return panel_pictures(
        PanelFigure(told=told, draw=draw, rows=rows, widths=_WIDTHS, legend=signs), about
    )


def _draw_parts(axes: Axes, row: int, bar: Bar, scale: Scale, prefix: str, inches: float) -> Hints:
    """Draw one bar; return what its parts tell."""
    low, high = scale.limits or (0.0, 100.0)
    if not bar.parts:
        axes.text((low + high) / 2, row, "no answers", ha="center", va="center", fontsize=7.5)
    hints: Hints = {}
    left = bar.start
    for level, part in enumerate(bar.parts):
        gid = f"{prefix}-{level}"
        axes.barh(row, part.percent, left=left, height=0.66, color=part.colour)[0].set_gid(gid)
        hints[gid] = part.hint
        if part.percent / (high - low) * inches >= _NARROWEST:
            _write(axes, left + part.percent / 2, row, f"{part.percent:.0f}", part.colour, 7.0)
        left += part.percent
    return hints


def _write(
    axes: Axes, x: float, y: float, text: str, colour: str, size: float, *, bold: bool = False
) -> None:
    axes.text(
        x,
        y,
        text,
        ha="center",
        va="center_baseline",
        color=on(colour),
        fontsize=size,
        fontweight="bold" if bold else "normal",
    )


def _tell(name: str, bar: Bar, measure: str) -> str:
    if not bar.parts:
        return f"{name}: no answers."
    parts = ", ".join(part.hint for part in bar.parts)
    return f"{name}: {parts}; {measure} {bar.words} {bar.below}."


class Won(NamedTuple):
    """A win share against one condition, in words, and whether its test decides."""

    share: float
    words: str
    decided: bool


def matrix_pictures(
    questions: Mapping[str, Mapping[tuple[str, str], Won]],
    conditions: Sequence[str],
    about: About,
) -> tuple[Picture, ...]:
    """Draw a matrix per question: the share of the row's condition against the column's.

    Parameters
    ----------
    questions : mapping of str to mapping of (str, str) to Won
        By question, and then by the condition that wins and the one it wins against.
    conditions : sequence of str
        Rows and columns, in order; columns are numbered as the rows are.
    about : About
        What stands around the figure.
    """
    count = len(conditions)

    def draw(panel: Panel, question: str) -> Hints:
        axes, hints = panel.axes[0], Hints()
        size = min(LABEL_SIZE, 24 * panel.inches / count)
        for spine in axes.spines.values():
            spine.set_visible(False)
        axes.set_xlim(-0.5, count - 0.5)
        axes.set_xticks(range(count), labels=[str(k + 1) for k in range(count)])
        axes.tick_params(axis="x", length=0, top=True, labeltop=True, labelbottom=False, pad=2)
        for row, one in enumerate(conditions):
            axes.text(row, row, "–", ha="center", va="center", fontsize=size)
            for column, other in enumerate(conditions):
                won = questions[question].get((one, other))
                if won is None:
                    continue
                colour, gid = between_sides(1 - won.share), f"cell{panel.prefix}-{row}-{column}"
                cell = axes.barh(row, 1, 1, left=column - 0.5, color=colour, edgecolor=PAPER)
                cell[0].set_gid(gid)
                hints[gid] = f"{wording.against(one, other)}: {won.words}"
                text = wording.share(won.share)
                _write(axes, column, row, text, colour, size, bold=won.decided)
        return hints

    place = {name: number for number, name in enumerate(conditions)}
    told = {
        question: f"{wording.heading(question)}. "
        + "; ".join(
            f"{wording.against(one, other)}: {won.words}"
            for (one, other), won in shares.items()
            if place[one] < place[other]
        )
        + "."
        for question, shares in questions.items()
    }
    rows = [Row(f"{number} {wording.condition(one)}") for number, one in enumerate(conditions, 1)]
    columns = 2 if count <= 6 else 1
    return panel_pictures(PanelFigure(told=told, draw=draw, rows=rows, columns=columns), about)
