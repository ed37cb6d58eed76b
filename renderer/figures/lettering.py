"""Text in pictures, in the font that comes with matplotlib: no system font is needed."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Final

import matplotlib as mpl
from PIL import ImageFont

INK: Final = "#222226"
FAINT_INK: Final = "#6a6a72"


@cache
def font(size: float, *, bold: bool = False) -> ImageFont.FreeTypeFont:
    """Return DejaVu Sans of `size` pixels; it covers Latin, Greek, Cyrillic and more."""
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return ImageFont.truetype(Path(mpl.get_data_path()) / "fonts" / "ttf" / name, size)


def fitted(text: str, letters: ImageFont.FreeTypeFont, width: float) -> str:
    """Return `text` in one line, cut with an ellipsis where it is wider than `width` pixels."""
    text = _printable(text)
    if letters.getlength(text) <= width:
        return text
    while text and letters.getlength(text + "…") > width:
        text = text[:-1]
    return text.rstrip() + "…"


def wrapped(text: str, letters: ImageFont.FreeTypeFont, width: float, lines: int) -> list[str]:
    """Return `text` broken into at most `lines` lines of at most `width` pixels.

    Words are kept whole where they fit; what does not fit ends with an ellipsis.
    """
    words = _printable(text).split()
    done: list[str] = []
    while words and len(done) < lines - 1:
        line = words.pop(0)
        while words and letters.getlength(f"{line} {words[0]}") <= width:
            line += f" {words.pop(0)}"
        done.append(fitted(line, letters, width))
    if words:
        done.append(fitted(" ".join(words), letters, width))
    return done


def _printable(text: str) -> str:
    """Return `text` in one line without signs that no font can draw."""
    return "".join(sign for sign in " ".join(text.split()) if sign.isprintable())
