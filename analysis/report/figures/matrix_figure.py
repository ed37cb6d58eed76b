"""Win shares of every condition against every other one, as a matrix."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from analysis.report import wording
from analysis.report.content import Picture
from analysis.report.figures.ink import PAPER, STYLE, between_sides, on
from analysis.report.figures.panels import (
    LABEL_SIZE,
    NARROW,
    TITLE_SIZE,
    WIDE,
    Format,
    numbered,
)
from analysis.report.figures.sheet import POINTS, Sheet, fitted
from analysis.report.figures.svg import Drawing, picture

_LARGEST_CELL: Final = 0.5
_HEAD: Final = 0.42
_BELOW: Final = 0.16
_BESIDE: Final = 0.3


@dataclass(frozen=True, kw_only=True)
class Won:
    """A win share against one condition, in words, and whether its test decides."""

    share: float
    words: str
    decided: bool


def matrix_pictures(
    questions: Mapping[str, Mapping[tuple[str, str], Won]],
    conditions: Sequence[str],
    *,
    name: str,
    title: str,
    caption: str,
    data: str,
    mark: str,
) -> tuple[Picture, ...]:
    """Draw a matrix per question: the share of the row's condition against the column's.

    Parameters
    ----------
    questions : mapping of str to mapping of (str, str) to Won
        By question, and then by the condition that wins and the one it wins against.
    conditions : sequence of str
        Rows and columns, in order; columns are numbered as the rows are.
    name, title, caption, data
        See `analysis.report.figures.svg.picture`.
    mark : str
        Written on top; empty for none.
    """
    grid = _Grid.of(WIDE, conditions, len(questions))
    per_sheet = max(1, int(WIDE.tallest // grid.line)) * grid.columns
    asked = list(questions)
    pages = [asked[start : start + per_sheet] for start in range(0, len(asked), per_sheet)]
    found = []
    for page, own_name in zip(pages, numbered(name, len(pages)), strict=True):
        shown = {question: questions[question] for question in page}
        with mpl.rc_context(STYLE):
            wide = _drawn(shown, conditions, grid, mark)
            found.append(
                picture(
                    wide.figure,
                    hints=wide.hints,
                    narrow=_drawn(shown, conditions, _Grid.of(NARROW, conditions, 1), mark),
                    name=own_name,
                    title=title,
                    alt=_alt(shown, conditions),
                    caption=caption,
                    data=data,
                )
            )
    return tuple(found)


@dataclass(frozen=True, kw_only=True)
class _Grid:
    """Where matrices stand: the size of a cell and of a matrix with its title, in inches."""

    room: Format
    cell: float
    wide: float
    line: float
    columns: int

    @classmethod
    def of(cls, room: Format, conditions: Sequence[str], matrices: int) -> _Grid:
        count, free = len(conditions), room.width - room.labels
        cell = min(_LARGEST_CELL, free / count)
        beside = int((free + _BESIDE) // (cell * count + _BESIDE))
        return cls(
            room=room,
            cell=cell,
            wide=cell * count,
            line=_HEAD + cell * count + _BELOW,
            columns=max(1, min(room.columns, matrices, beside)),
        )


def _drawn(
    questions: Mapping[str, Mapping[tuple[str, str], Won]],
    conditions: Sequence[str],
    grid: _Grid,
    mark: str,
) -> Drawing:
    sheet = Sheet(grid.line * -(-len(questions) // grid.columns), mark=mark, width=grid.room.width)
    hints: dict[str, str] = {}
    for number, (question, shares) in enumerate(questions.items()):
        row, column = divmod(number, grid.columns)
        left, top = grid.room.labels + column * (grid.wide + _BESIDE), row * grid.line
        title = fitted(wording.heading(question), grid.wide, size=TITLE_SIZE, bold=True)
        sheet.write(left, top + 0.12, title, fontsize=TITLE_SIZE, fontweight="bold", va="baseline")
        _write_names(sheet, conditions, grid, left, top, named=not column)
        axes = sheet.panel(left, top + _HEAD, grid.wide, grid.wide)
        hints |= _matrix(axes, shares, conditions, grid.cell, f"cell{number}")
    return Drawing(figure=sheet.figure, hints=hints)


def _write_names(
    sheet: Sheet, conditions: Sequence[str], grid: _Grid, left: float, top: float, *, named: bool
) -> None:
    """Write numbers over the columns; at the left of the first matrix, the rows' names too."""
    for row, one in enumerate(conditions):
        number = str(row + 1)
        sheet.write(
            left + (row + 0.5) * grid.cell,
            top + _HEAD - 0.05,
            number,
            ha="center",
            va="baseline",
            fontsize=LABEL_SIZE,
        )
        if not named:
            continue
        middle = top + _HEAD + (row + 0.5) * grid.cell
        size = min(LABEL_SIZE, 24 * grid.cell)
        lines = max(1, int(grid.cell * POINTS / (1.2 * size)))
        name = fitted(wording.name(one), left - 0.35, size=size, lines=min(lines, 3))
        sheet.write(left - 0.3, middle, name, ha="right", va="center", fontsize=size)
        sheet.write(left - 0.08, middle, number, ha="right", va="center", fontsize=size)


def _matrix(
    axes: Axes,
    shares: Mapping[tuple[str, str], Won],
    conditions: Sequence[str],
    cell: float,
    prefix: str,
) -> dict[str, str]:
    axes.set_axis_off()
    axes.set_xlim(0, len(conditions))
    axes.set_ylim(len(conditions), 0)
    size = min(LABEL_SIZE, 24 * cell)
    hints: dict[str, str] = {}
    for row, one in enumerate(conditions):
        axes.text(row + 0.5, row + 0.5, "–", ha="center", va="center", fontsize=size)
        for column, other in enumerate(conditions):
            won = shares.get((one, other))
            if won is None:
                continue
            colour, gid = between_sides(1 - won.share), f"{prefix}-{row}-{column}"
            axes.add_patch(
                Rectangle((column, row), 1, 1, facecolor=colour, edgecolor=PAPER, gid=gid)
            )
            hints[gid] = f"{wording.name(one)} against {wording.name(other)}: {won.words}"
            axes.text(
                column + 0.5,
                row + 0.5,
                wording.share(won.share),
                ha="center",
                va="center_baseline",
                fontsize=size,
                fontweight="bold" if won.decided else "normal",
                color=on(colour),
            )
    return hints


def _alt(questions: Mapping[str, Mapping[tuple[str, str], Won]], conditions: Sequence[str]) -> str:
    place = {name: number for number, name in enumerate(conditions)}
    return "; ".join(
        f"{wording.name(question)}, {wording.name(one)} against {wording.name(other)}: {won.words}"
        for question, shares in questions.items()
        for (one, other), won in shares.items()
        if place[one] < place[other]
    )
