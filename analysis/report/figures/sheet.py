"""A figure laid out in inches from its top left corner, and words that fit where they stand."""

from __future__ import annotations

import warnings
from functools import cache
from typing import Any, Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.text import Text
from matplotlib.textpath import TextToPath

from analysis.report.figures.ink import MARK
from analysis.report.figures.svg import WIDTH

POINTS: Final = 72.0
"""Points in an inch."""

_MARK_ROOM: Final = 0.2


class Sheet:
    """A figure of the report's width; its mark, if it has one, stands above everything else.

    Parameters
    ----------
    height : float
        In inches, without the mark.
    mark : str
        Written on top, so that a copied figure keeps it; empty for none.
    width : float, optional
        In inches.
    """

    def __init__(self, height: float, *, mark: str = "", width: float = WIDTH) -> None:
        self._above = _MARK_ROOM if mark else 0.0
        self._width, self._height = width, height + self._above
        self.figure = Figure(figsize=(self._width, self._height))
        if mark:
            self.figure.text(
                0.0,
                1 - 0.02 / self._height,
                mark,
                va="top",
                color=MARK,
                fontsize=7.5,
                fontweight="bold",
            )

    def panel(self, left: float, top: float, width: float, height: float, **settings: Any) -> Axes:
        """Return axes with their upper left corner at `left`, `top`."""
        bottom = self._height - self._above - top - height
        return self.figure.add_axes(
            (
                left / self._width,
                bottom / self._height,
                width / self._width,
                height / self._height,
            ),
            **settings,
        )

    def write(self, left: float, top: float, text: str, **settings: Any) -> Text:
        """Write text at `left`, `top`; where its box lies there, `ha` and `va` say."""
        return self.figure.text(
            left / self._width, 1 - (top + self._above) / self._height, text, **settings
        )


def fitted(text: str, inches: float, *, size: float, lines: int = 1, bold: bool = False) -> str:
    """Break text into at most `lines` that are no wider than `inches`; '…' stands for the rest.

    Parameters
    ----------
    text : str
        Words.
    inches : float
        Room.
    size : float
        Of the font, in points.
    lines : int
        How many at most.
    bold : bool
        Whether the words will be bold.
    """
    room = inches * POINTS / size
    found: list[str] = []
    rest = text.split()
    while rest and len(found) < lines:
        taken, rest = _line(rest, room, bold)
        found.append(taken)
    if rest:
        found[-1] = _ended(f"{found[-1]} {rest[0]}", room, bold)
    return "\n".join(found)


def inches_of(text: str, size: float) -> float:
    """Return the width of text in inches, in a font of `size` points."""
    return _wide(text, bold=False) * size / POINTS


def _line(words: list[str], room: float, bold: bool) -> tuple[str, list[str]]:
    """Return what fits on one line, one sign at least, and the words that are left."""
    line = words[0]
    if _wide(line, bold) > room:
        count = max(1, _signs(line, room, bold))
        return line[:count], [line[count:], *words[1:]]
    for place, word in enumerate(words[1:], start=1):
        if _wide(f"{line} {word}", bold) > room:
            return line, words[place:]
        line = f"{line} {word}"
    return line, []


def _ended(line: str, room: float, bold: bool) -> str:
    return f"{line[: _signs(line, room - _wide('…', bold), bold)].rstrip()}…"


def _signs(text: str, room: float, bold: bool) -> int:
    """Return how many signs from the beginning of the text fit."""
    wide = 0.0
    for place, sign in enumerate(text):
        wide += _wide(sign, bold)
        if wide > room:
            return place
    return len(text)


def _wide(text: str, bold: bool) -> float:
    """Return the width of text in sizes of its font."""
    return sum(_sign_width(sign, bold) for sign in text)


@cache
def _sign_width(sign: str, bold: bool) -> float:
    font = FontProperties(family="DejaVu Sans", size=100, weight="bold" if bold else "normal")
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from font")
        width, _, _ = TextToPath().get_text_width_height_descent(sign, font, ismath=False)
    return float(width) / 100
