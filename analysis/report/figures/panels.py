"""Figures of panels: on sheets for a page, and once more in one column for a narrow screen.

Matplotlib's constrained layout finds the places; a figure gets the height that its panels need.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from analysis.report import wording
from analysis.report.content import About, Picture
from analysis.report.figures.style import (
    LABEL_SIZE,
    MARK,
    STYLE,
    TITLE_SIZE,
    WIDTH,
    Drawing,
    fitted,
    picture,
)

_ROW_LINE: Final = 0.135
"""Height in inches of a line of a row's name."""

_AROUND: Final = 0.85
"""Height in inches that a panel's title, axis and what it shows take at most."""

_LEGEND_COLUMN: Final = 1.4
"""Width in inches that a word of a legend needs at least."""

_LEGEND_SIGN: Final = 0.38
"""Width in inches that a sign and the space around it take."""

Hints = dict[str, str]
"""What a reader sees who points at a part of a figure, by the part's gid."""


@dataclass(frozen=True, kw_only=True)
class Format:
    """How much room there is, in inches.

    Attributes
    ----------
    width, tallest : float
        Of a sheet.
    labels : float
        For the rows' names, at the left, at most.
    columns, lines : int
        Panels beside each other, and lines of a row's name, at most.
    """

    width: float
    tallest: float
    labels: float
    columns: int
    lines: int


WIDE: Final = Format(width=WIDTH, tallest=9.0, labels=1.3, columns=3, lines=2)
"""A page of A4, and the screen of a computer."""

NARROW: Final = Format(width=3.6, tallest=1000.0, labels=0.95, columns=1, lines=3)
"""The screen of a telephone, which scrolls."""


class Row(NamedTuple):
    """What stands at the left of a row: its name, and a word below it such as 'n = 23'."""

    name: str
    below: str = ""

    def text(self, room: Format) -> str:
        """Return both, broken into lines."""
        name = fitted(self.name, room.labels - 0.1, size=LABEL_SIZE, lines=room.lines)
        return f"{name}\n{self.below}" if self.below else name


class Panel(NamedTuple):
    """Where one panel is drawn: its axes, the beginning of its gids, and its width in inches."""

    axes: Sequence[Axes]
    prefix: str
    inches: float
    is_first: bool


@dataclass(frozen=True, kw_only=True)
class PanelFigure:
    """What a figure shows, whatever its panels draw.

    Attributes
    ----------
    told : mapping of str to str
        By question, or whatever else heads a panel: what it shows in words, with the numbers.
    draw : callable
        Draws what a question's panel shows, and returns the panel's hints.
    rows : sequence of Row
        From the top, the same in every panel; () for none.
    height : float
        Of a panel in inches; 0 for what the rows need.
    widths : tuple of float
        Shares of a panel's width that its axes take.
    columns : int
        Panels beside each other on a wide sheet, at most.
    legend : sequence of Artist
        Signs with their words as labels.
    """

    told: Mapping[str, str]
    draw: Callable[[Panel, str], Hints]
    rows: Sequence[Row] = ()
    height: float = 0.0
    widths: tuple[float, ...] = (1.0,)
    columns: int = 2
    legend: Sequence[Artist] = ()

    def panel_height(self, room: Format) -> float:
        """Return the height of a panel in inches."""
        if self.height:
            return self.height
        lines = max(row.text(room).count("\n") + 1 for row in self.rows)
        return len(self.rows) * max(lines * _ROW_LINE + 0.08, 0.29)


def panel_pictures(figure: PanelFigure, about: About) -> tuple[Picture, ...]:
    """Draw a figure on as many sheets as it needs."""
    questions = list(figure.told)
    foot = 0.3 * math.ceil(len(figure.legend) * _LEGEND_COLUMN / WIDE.width) + 0.2
    lines = max(1, int((WIDE.tallest - foot) / (figure.panel_height(WIDE) + _AROUND)))
    per_sheet = lines * min(figure.columns, WIDE.columns)
    sheets = [questions[k : k + per_sheet] for k in range(0, len(questions), per_sheet)]
    found = []
    for number, shown in enumerate(sheets, start=1):
        own = about
        if len(sheets) > 1:
            which = f"{about.caption} ({number} of {len(sheets)})"
            own = replace(about, name=f"{about.name}-{number}", caption=which)
        wide, narrow = (draw_sheet(figure, shown, about.mark, room) for room in (WIDE, NARROW))
        told = " ".join(figure.told[question] for question in shown)
        found.append(picture(wide, own, told, narrow=narrow))
    return tuple(found)


def draw_sheet(
    what: PanelFigure, questions: Sequence[str], mark: str = "", room: Format = WIDE
) -> Drawing:
    """Draw the panels of some questions.

    Parameters
    ----------
    what : PanelFigure
        All that is shown.
    questions : sequence of str
        Those whose panels the sheet has.
    mark : str, optional
        Written on top, so that a copied figure keeps it; empty for none.
    room : Format, optional
        Of the sheet.
    """
    columns = min(what.columns, room.columns, len(questions))
    lines = math.ceil(len(questions) / columns)
    high, axes_each = what.panel_height(room), len(what.widths)
    inches = (room.width - (room.labels if what.rows else 0.6)) / columns - 0.15
    hints: Hints = {}
    with mpl.rc_context(STYLE):
        size = (room.width, lines * (high + 2) + 2)
        layout = ConstrainedLayoutEngine(h_pad=0.06, w_pad=0.06)
        figure = Figure(figsize=size, layout=layout)
        grid = figure.subplots(
            lines, columns * axes_each, squeeze=False, width_ratios=what.widths * columns
        )
        for number, question in enumerate(questions):
            line, column = divmod(number, columns)
            axes = grid[line, column * axes_each : (column + 1) * axes_each]
            title = fitted(wording.heading(question), inches, size=TITLE_SIZE, lines=3, bold=True)
            axes[0].set_title(title, loc="left", fontsize=TITLE_SIZE, fontweight="bold")
            for one, other in zip(axes, grid[0], strict=False):
                _name_rows(one, what.rows, room, named=not column and one is axes[0])
                if what.rows and number:
                    one.sharex(other)
            panel = Panel(tuple(axes), str(number), inches, not column)
            hints |= what.draw(panel, question)
        for unused in grid[-1, (len(questions) - (lines - 1) * columns) * axes_each :]:
            unused.remove()
        _add_legend(figure, what.legend, room)
        if mark:
            figure.suptitle(mark, x=0.0, ha="left", color=MARK, fontsize=7.5, fontweight="bold")
        _fit_height(figure, layout, high)
    return Drawing(figure=figure, hints=hints)


def _name_rows(axes: Axes, rows: Sequence[Row], room: Format, *, named: bool) -> None:
    if not rows:
        return
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_yticks([])
    if named:
        axes.set_yticks(
            np.arange(len(rows)), labels=[row.text(room) for row in rows], fontsize=LABEL_SIZE
        )
    axes.tick_params(axis="y", length=0)


def _add_legend(figure: Figure, signs: Sequence[Artist], room: Format) -> None:
    if not signs:
        return
    lines = math.ceil(len(signs) / int(room.width / _LEGEND_COLUMN))
    columns = math.ceil(len(signs) / lines)
    wide = room.width / columns - _LEGEND_SIGN
    figure.legend(
        handles=list(signs),
        labels=[fitted(str(sign.get_label()), wide, size=7.5, lines=2) for sign in signs],
        loc="outside lower center",
        ncols=columns,
        frameon=False,
        fontsize=7.5,
        handlelength=1.0,
        columnspacing=1.2,
        labelspacing=0.4,
    )


def _fit_height(figure: Figure, layout: ConstrainedLayoutEngine, wanted: float) -> None:
    """Lay the figure out once, and give its panels the height that they are to have."""
    layout.execute(figure)
    figure.set_layout_engine("none")
    before = figure.get_figheight()
    more = wanted - figure.axes[0].get_position().height * before
    lines = 1 + max(_line_of(axes) for axes in figure.axes)
    after = before + lines * more
    for axes in figure.axes:
        # What stands around panels keeps its height: lines of panels move as far as others grew.
        place = axes.get_position()
        bottom = after - before * (1 - place.y1) - _line_of(axes) * more - wanted
        axes.set_position((place.x0, bottom / after, place.width, wanted / after))
    if figure.get_suptitle():
        (mark,) = figure.texts
        mark.set_y(1 - (1 - mark.get_position()[1]) * before / after)
    figure.set_figheight(after)


def _line_of(axes: Axes) -> int:
    place = axes.get_subplotspec()
    return 0 if place is None else place.rowspan.start
