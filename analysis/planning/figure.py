"""A plan's figure: power over participants, a line for each number of segments."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Final

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullFormatter, NullLocator

from analysis.planning.plan import Plan
from analysis.planning.power import Power
from analysis.planning.smallest import WANTED
from analysis.planning.words import segments
from analysis.report.figures.ink import INK, LINE, SERIES, SOFT, STYLE
from analysis.report.figures.sheet import Sheet, fitted
from analysis.report.figures.svg import WIDTH, as_pdf

ACROSS: Final = 3
"""Panels beside one another."""

MARKS: Final = ("o", "s", "^", "D", "v", "P", "X", "*")
DASHES: Final = ("-", "--", "-.", ":")

_LEFT: Final = 0.72
_BETWEEN: Final = 0.18
_HEAD: Final = 0.32
_TITLE: Final = 0.45
_HIGH: Final = 1.75
_AXIS: Final = 0.34
_FOOT: Final = 0.26
"""Room in inches: left of the panels, between them, for the legend, for a panel's title, for the
panel, for the numbers under it, and for what they count."""


def power_figure(plan: Plan) -> Figure:
    """Draw a panel for each effect, a row of panels for each part of the study."""
    panels = [(n, effect) for n in range(len(plan.parts)) for effect in plan.request.effects]
    across = min(ACROSS, len(plan.request.effects))
    per_part = -(-len(plan.request.effects) // across)
    rows = per_part * len(plan.parts)
    high = _TITLE + _HIGH + _AXIS
    with mpl.rc_context(STYLE):
        sheet = Sheet(_HEAD + rows * high + _FOOT)
        wide = (WIDTH - _LEFT - 0.1 - (across - 1) * _BETWEEN) / across
        for number, effect in panels:
            place = plan.request.effects.index(effect)
            row, column = number * per_part + place // across, place % across
            left, top = _LEFT + column * (wide + _BETWEEN), _HEAD + row * high + _TITLE
            axes = sheet.panel(left, top, wide, _HIGH)
            _panel(axes, plan, number, effect)
            axes.tick_params(labelleft=not column, left=not column)
            _title(sheet, plan, number, effect, (left, top - 0.08), wide)
        for row in range(rows):
            sheet.write(
                0.22,
                _HEAD + row * high + _TITLE + _HIGH / 2,
                "How often a true difference\nis found (± 2 errors)",
                rotation=90,
                ha="center",
                va="center",
                fontsize=8,
                linespacing=1.2,
            )
        each = " in each comparison" if plan.request.per_comparison else ""
        sheet.write(
            _LEFT,
            _HEAD + rows * high,
            f"How many participants take part{each}",
            va="top",
            fontsize=8,
        )
        _legend(sheet, plan)
    return sheet.figure


def as_png(figure: Figure) -> bytes:
    """Return the figure as PNG, 200 dots an inch."""
    stream = io.BytesIO()
    with mpl.rc_context(STYLE):
        figure.savefig(stream, format="png", dpi=200, metadata={"Software": None})
    return stream.getvalue()


def as_svg(figure: Figure) -> bytes:
    """Return the figure as an SVG file without a date."""
    stream = io.BytesIO()
    with mpl.rc_context({**STYLE, "svg.hashsalt": "power"}):
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return stream.getvalue()


FORMATS: Final = {"png": as_png, "svg": as_svg, "pdf": as_pdf}
"""How the figure is written, by the ending of its file."""


def _panel(axes: Axes, plan: Plan, number: int, effect: float) -> None:
    axes.axhline(WANTED, color=SOFT, linewidth=0.8, linestyle=(0, (2, 2)), zorder=1)
    people = sorted(set(plan.request.participants))
    for place, items in enumerate(plan.request.items):
        cells = [plan.cell(count, items, effect) for count in people]
        powers = [cell.powers[number] for cell in cells if cell is not None]
        colour = SERIES[place % len(SERIES)]
        axes.errorbar(
            people,
            [power.power for power in powers],
            yerr=_reach(powers),
            color=colour,
            marker=MARKS[place % len(MARKS)],
            markersize=4,
            linestyle=DASHES[place % len(DASHES)],
            linewidth=1.3,
            elinewidth=0.8,
            clip_on=False,
            zorder=3,
        )
        if plan.request.own is not None and plan.request.own[1] == items:
            count = plan.request.own[0]
            own = [power for power, each in zip(powers, people, strict=True) if each == count]
            axes.plot(
                [count] * len(own),
                [power.power for power in own],
                marker="o",
                markersize=10,
                markerfacecolor="none",
                markeredgecolor=INK,
                markeredgewidth=0.9,
                linestyle="none",
                clip_on=False,
                zorder=4,
            )
    axes.set_ylim(0, 1)
    axes.set_yticks([0, 0.2, 0.4, 0.6, 0.8, 1], ["0", ".2", ".4", ".6", ".8", "1"])
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(FixedLocator(people))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xticks(people, [str(count) for count in people])
    margin = 1.12
    axes.set_xlim(people[0] / margin, people[-1] * margin)
    axes.grid(axis="y", color=LINE, linewidth=0.4)
    axes.set_axisbelow(True)


def _reach(powers: Sequence[Power]) -> tuple[list[float], list[float]]:
    """Return how far two errors reach down and up, within what a share can be."""
    return (
        [min(2 * power.error, power.power) for power in powers],
        [min(2 * power.error, 1 - power.power) for power in powers],
    )


def _title(
    sheet: Sheet, plan: Plan, number: int, effect: float, place: tuple[float, float], wide: float
) -> None:
    part = plan.parts[number]
    name = f"{part}: " if part else ""
    words = (
        f"{name}{effect:g} logits:\n{fitted(plan.meanings[part, effect], wide, size=7.5, lines=2)}"
    )
    sheet.write(*place, words, va="bottom", fontsize=7.5, linespacing=1.25)


def _legend(sheet: Sheet, plan: Plan) -> None:
    """Write on top which line is which."""
    left = _LEFT
    for place, items in enumerate(plan.request.items):
        axes = sheet.panel(left, 0.06, 0.3, 0.12)
        axes.set_axis_off()
        axes.plot(
            [0, 1],
            [0, 0],
            color=SERIES[place % len(SERIES)],
            marker=MARKS[place % len(MARKS)],
            markersize=4,
            markevery=[1],
            linestyle=DASHES[place % len(DASHES)],
            linewidth=1.3,
            clip_on=False,
        )
        sheet.write(left + 0.4, 0.12, segments(items), va="center", fontsize=8)
        left += 1.35
    if plan.request.own is not None:
        axes = sheet.panel(left, 0.06, 0.2, 0.12)
        axes.set_axis_off()
        axes.plot(
            [0.5],
            [0],
            marker="o",
            markersize=9,
            markerfacecolor="none",
            markeredgecolor=INK,
            linestyle="none",
            clip_on=False,
        )
        sheet.write(left + 0.3, 0.12, "the study as it stands", va="center", fontsize=8)
