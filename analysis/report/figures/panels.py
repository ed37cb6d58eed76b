"""Where panels stand: two beside each other, their rows named, on sheets that fit a page.

A panel shows one question. All panels of a figure have the same rows, named once on the left.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from matplotlib.axes import Axes

from analysis.report.figures.ink import SOFT
from analysis.report.figures.sheet import Sheet, fitted, inches_of
from analysis.report.figures.svg import WIDTH

TALLEST: Final = 9.0
"""Height in inches that a figure may have on a page of A4."""

TITLE_SIZE: Final = 9.0
LABEL_SIZE: Final = 8.0
SMALL_SIZE: Final = 7.0

_GAP: Final = 0.18
_TITLE_LINE: Final = 0.16
_ROW_LINE: Final = 0.135
_AXIS: Final = 0.42
_BETWEEN: Final = 0.12


@dataclass(frozen=True, kw_only=True)
class Format:
    """How much room there is, in inches.

    Attributes
    ----------
    width, tallest : float
        Of a sheet.
    labels : float
        For the rows' names, at the left.
    columns : int
        Panels beside each other, at most.
    lines : int
        Of a row's name, at most.
    """

    width: float
    tallest: float
    labels: float
    columns: int
    lines: int


WIDE: Final = Format(width=WIDTH, tallest=TALLEST, labels=1.3, columns=2, lines=2)
"""A page of A4, and the screen of a computer."""

NARROW: Final = Format(width=3.6, tallest=1000.0, labels=0.95, columns=1, lines=3)
"""The screen of a telephone, which scrolls."""


@dataclass(frozen=True, kw_only=True)
class RowName:
    """What stands at the left of a row: its name, and a word below it such as 'n = 23'."""

    name: str
    below: str = ""

    def text(self, room: Format) -> str:
        """Return both, broken into lines that leave a margin."""
        lines = [fitted(self.name, room.labels - 0.1, size=LABEL_SIZE, lines=room.lines)]
        return "\n".join([*lines, self.below] if self.below else lines)


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where one panel stands, in inches from the upper left corner of its sheet.

    Attributes
    ----------
    number : int
        Of the panel, from 0.
    left, top, width, height : float
        Of what it draws in.
    head : float
        Room for its title above that.
    first : bool
        Whether the rows' names stand at its left.
    """

    number: int
    left: float
    top: float
    width: float
    height: float
    head: float
    first: bool


@dataclass(frozen=True, kw_only=True)
class Plan:
    """One sheet: its height, and the places of its panels."""

    height: float
    places: tuple[Place, ...]


def plans(
    titles: Sequence[str],
    names: Sequence[RowName],
    *,
    foot: float = 0.0,
    room: Format = WIDE,
) -> list[Plan]:
    """Share panels out to as many sheets as they need.

    Parameters
    ----------
    titles : sequence of str
        One for each panel.
    names : sequence of RowName
        Of the rows.
    foot : float, optional
        Room at the bottom of each sheet, in inches, such as for a legend.
    room : Format, optional
        Of a sheet.
    """
    columns = min(len(titles), room.columns)
    width = (room.width - room.labels - (columns - 1) * _GAP) / columns
    head = _title_lines(titles, width) * _TITLE_LINE + 0.06
    rows = row_height(names, room) * len(names)
    line = head + rows + _AXIS + _BETWEEN
    lines = -(-len(titles) // columns)
    per_sheet = int(min(max(1, (room.tallest - foot) // line), lines))
    found = []
    for start in range(0, lines, per_sheet):
        inside = min(per_sheet, lines - start)
        places = [
            Place(
                number=number,
                left=room.labels + (number % columns) * (width + _GAP),
                top=(number // columns - start) * line + head,
                width=width,
                height=rows,
                head=head,
                first=number % columns == 0,
            )
            for number in range(start * columns, min((start + inside) * columns, len(titles)))
        ]
        found.append(Plan(height=inside * line - _BETWEEN + foot, places=tuple(places)))
    return found


def row_height(names: Sequence[RowName], room: Format = WIDE) -> float:
    """Return the height that every row needs, in inches."""
    lines = max(name.text(room).count("\n") + 1 for name in names)
    return max(lines * _ROW_LINE + 0.08, 0.29)


def write_title(sheet: Sheet, place: Place, title: str) -> None:
    """Write a panel's title above it."""
    text = fitted(title, place.width, size=TITLE_SIZE, lines=2, bold=True)
    sheet.write(
        place.left,
        # The baseline of several lines is that of the last one.
        place.top - place.head + 0.12 + text.count("\n") * _TITLE_LINE,
        text,
        fontsize=TITLE_SIZE,
        fontweight="bold",
        va="baseline",
        linespacing=1.1,
    )


def write_names(sheet: Sheet, place: Place, names: Sequence[RowName], room: Format) -> None:
    """Write the rows' names at the left of a panel that is the first of its line."""
    if not place.first:
        return
    height = place.height / len(names)
    for row, name in enumerate(names):
        text = name.text(room)
        sheet.write(
            place.left - 0.08,
            place.top + (row + 0.5) * height,
            text,
            fontsize=LABEL_SIZE,
            ha="right",
            va="center" if "\n" in text else "center_baseline",
            linespacing=1.1,
        )


@dataclass(frozen=True, kw_only=True)
class Scale:
    """The axis of a panel.

    Attributes
    ----------
    limits : (float, float)
        How far it goes.
    ticks : mapping of float to str
        Where its ticks are, and what they are called.
    label : str
        What it shows.
    ends : (str, str)
        What it shows towards its two ends, in place of `label`; ('', '') for neither.
    line : float or None
        Where a line goes through all rows.
    """

    limits: tuple[float, float]
    ticks: Mapping[float, str]
    label: str = ""
    ends: tuple[str, str] = ("", "")
    line: float | None = None


def dress(axes: Axes, rows: int, scale: Scale) -> None:
    """Give axes their scale; rows lie at 0, 1, … from the top."""
    axes.set_xlim(*scale.limits)
    axes.set_ylim(rows - 0.5, -0.5)
    axes.set_yticks([])
    axes.set_xticks(list(scale.ticks), labels=list(scale.ticks.values()))
    axes.tick_params(axis="x", labelsize=SMALL_SIZE, pad=1.5)
    axes.set_xlabel(scale.label, fontsize=SMALL_SIZE + 0.5, labelpad=2.0)
    ends: dict[float, Literal["left", "right"]] = {
        scale.limits[0]: "left",
        scale.limits[1]: "right",
    }
    for place, text in zip(scale.ticks, axes.get_xticklabels(), strict=True):
        # Words at the ends stay within the panel, so that neighbours do not touch.
        text.set_horizontalalignment(ends.get(place, "center"))
    if any(scale.ends):
        _write_ends(axes, scale.ends)
    if scale.line is not None:
        axes.axvline(scale.line, color=SOFT, linewidth=0.7, zorder=0)


def write_beside(axes: Axes, row: int, words: str, below: str, *, bold: bool = False) -> None:
    """Write words, and smaller ones under them, at the right of a row of a panel."""
    sizes = (8.5 if bold else 8.0, SMALL_SIZE - 0.5)
    heights = (4.4, -5.2) if below else (0.0, 0.0)
    for text, size, height in zip((words, below), sizes, heights, strict=True):
        axes.annotate(
            text,
            (1, row),
            xycoords=axes.get_yaxis_transform(),
            xytext=(8, height),
            textcoords="offset points",
            va="center",
            fontsize=size,
            fontweight="bold" if bold and text == words else "normal",
            annotation_clip=False,
        )


def _write_ends(axes: Axes, ends: tuple[str, str]) -> None:
    figure = axes.get_figure(root=True)
    wide = WIDTH if figure is None else figure.get_figwidth()
    room, size = axes.get_position().width * wide - 0.4, SMALL_SIZE + 0.5
    # The shorter of the two leaves the longer one what it does not need.
    shorter = min(room / 2, *(inches_of(text, size) for text in ends))
    left, right = (fitted(text, room - shorter, size=size, lines=2) for text in ends)
    for where, side, text in ((0.0, "left", f"← {left}"), (1.0, "right", f"{right} →")):
        axes.annotate(
            text,
            (where, 0),
            xycoords="axes fraction",
            xytext=(0, -13),
            textcoords="offset points",
            ha=side,
            va="top",
            fontsize=SMALL_SIZE + 0.5,
        )


def numbered(name: str, plan_count: int) -> Iterator[str]:
    """Give each sheet of a figure its name: one alone keeps the name as it is."""
    if plan_count == 1:
        yield name
        return
    for number in range(1, plan_count + 1):
        yield f"{name}-{number}"


def _title_lines(titles: Sequence[str], width: float) -> int:
    return max(
        fitted(title, width, size=TITLE_SIZE, lines=2, bold=True).count("\n") + 1
        for title in titles
    )
