"""Words that fit where they stand."""

from __future__ import annotations

import warnings
from functools import cache
from typing import Final

from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextToPath

POINTS: Final = 72.0
"""Points in an inch."""


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
