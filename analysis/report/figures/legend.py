"""What colours and marks mean, under a figure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from matplotlib.artist import Artist

from analysis.report.figures.ink import INK
from analysis.report.figures.sheet import Sheet, fitted
from analysis.report.figures.svg import WIDTH

_SIZE: Final = 7.5
_COLUMN: Final = 1.4
"""Inches that a column needs at least."""

_SIGN: Final = 0.38
"""Inches that a sign and the space around it take."""


@dataclass(frozen=True, kw_only=True)
class Entries:
    """Words of a legend, broken into lines, in so many columns; its height is in inches."""

    words: tuple[str, ...]
    columns: int
    height: float


def legend_entries(words: Sequence[str], width: float = WIDTH) -> Entries:
    """Return a legend's words, shared out to as few lines as a sheet of that width allows."""
    lines = -(-len(words) // int(width / _COLUMN))
    columns = -(-len(words) // lines)
    room = width / columns - _SIGN
    found = tuple(fitted(word, room, size=_SIZE, lines=2) for word in words)
    tallest = max(word.count("\n") + 1 for word in found)
    return Entries(words=found, columns=columns, height=0.1 + lines * (0.13 * tallest + 0.05))


def draw_legend(sheet: Sheet, signs: Sequence[Artist], entries: Entries) -> None:
    """Draw a legend at the bottom of a sheet, which `entries.height` was left free for.

    Parameters
    ----------
    sheet : Sheet
        Where.
    signs : sequence of Artist
        Each with one of the words as its label.
    entries : Entries
        The words.
    """
    legend = sheet.figure.legend(
        handles=list(signs),
        loc="lower center",
        ncols=entries.columns,
        frameon=False,
        fontsize=_SIZE,
        handlelength=1.0,
        columnspacing=1.2,
        labelspacing=0.4,
        borderaxespad=0.0,
        borderpad=0.0,
        bbox_to_anchor=(0.5, 0.0),
    )
    for text in legend.get_texts():
        text.set_color(INK)
