"""Figures of panels: on sheets for a page, and again in one column for a narrow screen.

Matplotlib's constrained layout places the panels; a figure gets the height that they need.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from analysis.report import wording
from analysis.report.content import FigureText, Picture
from analysis.report.figures.style import (
    LABEL_SIZE,
    MARK,
    STYLE,
    TITLE_SIZE,
    WIDTH,
    Drawing,
    fit_text,
    make_picture,
    missing_glyphs,
)

_LINE_HEIGHT: Final = 0.135
"""Height of a line of a row's name, in inches."""

_MAX_LINES: Final = 3
"""Most lines of a row's name; two lines would cut off 'first against second'."""

_MARGIN_HEIGHT: Final = 0.85
"""Largest height of a panel's title and axis, in inches."""

_LEGEND_COLUMN: Final = 1.4
"""Smallest width of a column of a legend, in inches."""

_LEGEND_KEY: Final = 0.38
"""Width of a key of a legend and the space around it, in inches."""


@dataclass(frozen=True, kw_only=True)
class Format:
    """The size of a sheet, in inches.

    Attributes
    ----------
    width, max_height : float
        Width and largest height of a sheet.
    label_width : float
        Largest width of the rows' names, at the left.
    max_columns : int
        Most panels side by side.
    """

    width: float
    max_height: float
    label_width: float
    max_columns: int


WIDE: Final = Format(width=WIDTH, max_height=9.0, label_width=1.3, max_columns=3)
"""A page of A4, and the screen of a computer."""

NARROW: Final = Format(width=3.6, max_height=1000.0, label_width=0.95, max_columns=1)
"""The screen of a telephone, which scrolls."""


class Row(NamedTuple):
    """The label of a row: its name, and a word below it such as 'n = 23'."""

    name: str
    below: str = ""

    def text(self, sheet: Format) -> str:
        """Return both, broken into lines."""
        width = sheet.label_width - 0.1
        name = fit_text(self.name, width, size=LABEL_SIZE, lines=_MAX_LINES)
        return f"{name}\n{self.below}" if self.below else name


class Panel(NamedTuple):
    """The place of a panel: its axes, its width in inches, and whether it is leftmost."""

    axes: Sequence[Axes]
    inches: float
    is_first: bool


@dataclass(frozen=True, kw_only=True)
class PanelFigure:
    """A figure of panels, usually one for each question.

    Attributes
    ----------
    titles : sequence of str
        The titles of the panels.
    draw : callable
        Draws the panel with a title, and yields it in words, for readers who cannot see it.
    rows : sequence of Row
        From the top, the same in every panel; () for none.
    height : float
        Height of a panel in inches; 0 to fit the rows.
    widths : tuple of float
        Shares of a panel's width for its axes.
    columns : int
        Most panels side by side on a wide sheet.
    legend : sequence of Artist
        Labelled artists.
    """

    titles: Sequence[str]
    draw: Callable[[Panel, str], Iterable[str]]
    rows: Sequence[Row] = ()
    height: float = 0.0
    widths: tuple[float, ...] = (1.0,)
    columns: int = 2
    legend: Sequence[Artist] = ()

    def panel_height(self, sheet: Format) -> float:
        """Return the height of a panel in inches."""
        if self.height:
            return self.height
        lines = max(row.text(sheet).count("\n") + 1 for row in self.rows)
        return len(self.rows) * max(lines * _LINE_HEIGHT + 0.08, 0.29)


def panel_pictures(figure: PanelFigure, text: FigureText) -> tuple[Picture, ...]:
    """Draw a figure on as many sheets as it needs."""
    titles = figure.titles
    legend_height = 0.3 * math.ceil(len(figure.legend) * _LEGEND_COLUMN / WIDE.width) + 0.2
    height = figure.panel_height(WIDE) + _MARGIN_HEIGHT
    lines = max(1, int((WIDE.max_height - legend_height) / height))
    per_sheet = lines * min(figure.columns, WIDE.max_columns)
    sheets = [titles[k : k + per_sheet] for k in range(0, len(titles), per_sheet)]
    pictures = []
    for number, shown in enumerate(sheets, start=1):
        sheet_text = text
        if len(sheets) > 1:
            caption = f"{text.caption} ({number} of {len(sheets)})"
            sheet_text = replace(text, name=f"{text.name}-{number}", caption=caption)
        wide, narrow = (draw_sheet(figure, shown, sheet) for sheet in (WIDE, NARROW))
        pictures.append(make_picture(wide, narrow, sheet_text))
    return tuple(pictures)


def draw_sheet(content: PanelFigure, titles: Sequence[str], sheet: Format = WIDE) -> Drawing:
    """Draw some of a figure's panels.

    Parameters
    ----------
    content : PanelFigure
        The figure.
    titles : sequence of str
        Titles of the panels on the sheet.
    sheet : Format, optional
        The size of the sheet.
    """
    columns = min(content.columns, sheet.max_columns, len(titles))
    lines = math.ceil(len(titles) / columns)
    panel_height, axes_per_panel = content.panel_height(sheet), len(content.widths)
    inches = (sheet.width - (sheet.label_width if content.rows else 0.6)) / columns - 0.15
    described = []
    with mpl.rc_context(STYLE):
        layout = ConstrainedLayoutEngine(h_pad=0.06, w_pad=0.06)
        figure = Figure(figsize=(sheet.width, lines * (panel_height + 2) + 2), layout=layout)
        grid = figure.subplots(
            lines, columns * axes_per_panel, squeeze=False, width_ratios=content.widths * columns
        )
        for number, title in enumerate(titles):
            line, column = divmod(number, columns)
            all_axes = grid[line, column * axes_per_panel : (column + 1) * axes_per_panel]
            all_axes[0].set_title(
                fit_text(wording.heading(title), inches, size=TITLE_SIZE, lines=3, bold=True),
                loc="left",
                fontsize=TITLE_SIZE,
                fontweight="bold",
            )
            for axes, first_axes in zip(all_axes, grid[0], strict=False):
                is_labelled = column == 0 and axes is all_axes[0]
                _label_rows(axes, content.rows, sheet, is_labelled=is_labelled)
                if content.rows and number:
                    axes.sharex(first_axes)
            words = content.draw(Panel(tuple(all_axes), inches, is_first=column == 0), title)
            described.append(f"{wording.heading(title)}. {'; '.join(words)}.")
        for unused in grid[-1, (len(titles) - (lines - 1) * columns) * axes_per_panel :]:
            unused.remove()
        _add_legend(figure, content.legend, sheet)
        # The mark is part of the figure, so that a copied figure keeps it.
        if mark := wording.figure_mark():
            figure.suptitle(mark, x=0.0, ha="left", color=MARK, fontsize=7.5, fontweight="bold")
        _fit_height(figure, layout, panel_height)
    return Drawing(figure, " ".join(described))


def _label_rows(axes: Axes, rows: Sequence[Row], sheet: Format, *, is_labelled: bool) -> None:
    if not rows:
        return
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_yticks([])
    if is_labelled:
        labels = [row.text(sheet) for row in rows]
        axes.set_yticks(np.arange(len(rows)), labels=labels, fontsize=LABEL_SIZE)
    axes.tick_params(axis="y", length=0)


def _add_legend(figure: Figure, handles: Sequence[Artist], sheet: Format) -> None:
    if not handles:
        return
    lines = math.ceil(len(handles) / int(sheet.width / _LEGEND_COLUMN))
    columns = math.ceil(len(handles) / lines)
    width = sheet.width / columns - _LEGEND_KEY
    figure.legend(
        handles=list(handles),
        labels=[fit_text(str(h.get_label()), width, size=7.5, lines=2) for h in handles],
        loc="outside lower center",
        ncols=columns,
        frameon=False,
        fontsize=7.5,
        handlelength=1.0,
        columnspacing=1.2,
        labelspacing=0.4,
    )


def _fit_height(figure: Figure, layout: ConstrainedLayoutEngine, panel_height: float) -> None:
    """Lay the figure out once, then give every panel its height."""
    with missing_glyphs():
        layout.execute(figure)
    figure.set_layout_engine(None)
    before = figure.get_figheight()
    growth = panel_height - figure.axes[0].get_position().height * before
    lines = 1 + max(_line_of(axes) for axes in figure.axes)
    after = before + lines * growth
    for axes in figure.axes:
        # The space around panels keeps its height: a line of panels moves as far as the lines
        # below it have grown.
        box = axes.get_position()
        bottom = after - before * (1 - box.y1) - _line_of(axes) * growth - panel_height
        axes.set_position((box.x0, bottom / after, box.width, panel_height / after))
    if figure.get_suptitle():
        (mark,) = figure.texts
        mark.set_y(1 - (1 - mark.get_position()[1]) * before / after)
    figure.set_figheight(after)


def _line_of(axes: Axes) -> int:
    spec = axes.get_subplotspec()
    return 0 if spec is None else spec.rowspan.start
