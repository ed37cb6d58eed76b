"""A printed page: pictures with text around them, as PNG and PDF.

Text has matplotlib's own font, so that no system font is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from PIL import Image, ImageFont

from motion.errors import InputError
from motion.files import replacing

# matplotlib is imported where it is used: it takes long, and not everybody draws.
if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK: Final = "#222226"
FAINT_INK: Final = "#6a6a72"

DOTS_PER_INCH: Final = 300
"""Resolution that journals require."""
POINTS_PER_INCH: Final = 72
LETTERS: Final = 8.0
"""Font size in points, that of captions in two-column papers."""
ENDINGS: Final = (".pdf", ".png")

# TrueType keeps text in a PDF searchable and editable.
_STYLE: Final[dict[Any, Any]] = {"pdf.fonttype": 42, "font.family": "DejaVu Sans"}
# Without dates, equal figures have equal bytes.
_NO_DATES: Final = {
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    ".png": {"Software": None},
}


@cache
def font(size: float) -> ImageFont.FreeTypeFont:
    """Return DejaVu Sans of `size` pixels; it covers Latin, Greek, Cyrillic and more."""
    from matplotlib import get_data_path

    return ImageFont.truetype(Path(get_data_path(), "fonts", "ttf", "DejaVuSans.ttf"), size)


def fitted(text: str, letters: ImageFont.FreeTypeFont, width: float) -> str:
    """Return `text` in one line, shortened with an ellipsis to `width` pixels."""
    text = _printable(text)
    if letters.getlength(text) <= width:
        return text
    while text and letters.getlength(text + "…") > width:
        text = text[:-1]
    return text.rstrip() + "…"


def wrapped(text: str, letters: ImageFont.FreeTypeFont, width: float, lines: int) -> list[str]:
    """Return `text` broken into at most `lines` lines of at most `width` pixels.

    Words are broken only if they do not fit; text that does not fit ends with an ellipsis.
    """
    words = _printable(text).split()
    finished: list[str] = []
    while words and len(finished) < lines - 1:
        line = words.pop(0)
        while words and letters.getlength(f"{line} {words[0]}") <= width:
            line += f" {words.pop(0)}"
        finished.append(fitted(line, letters, width))
    if words:
        finished.append(fitted(" ".join(words), letters, width))
    return finished


def _printable(text: str) -> str:
    """Return `text` in one line without unprintable characters."""
    return "".join(letter for letter in " ".join(text.split()) if letter.isprintable())


@dataclass(frozen=True)
class Plate:
    """A page of `width` × `height` pixels at `DOTS_PER_INCH`, first row on top.

    Pictures are placed on whole pixels, so that none of them is resampled.
    """

    width: int
    height: int
    figure: Figure

    @classmethod
    def of(cls, width: int, height: int, *, clear: bool) -> Plate:
        """Return an empty page, transparent if `clear`, otherwise white."""
        from matplotlib.figure import Figure

        figure = Figure(figsize=(width / DOTS_PER_INCH, height / DOTS_PER_INCH), dpi=DOTS_PER_INCH)
        figure.patch.set_facecolor("none" if clear else "white")
        return cls(width, height, figure)

    def area(self, left: float, top: float, width: float, height: float) -> Axes:
        """Return axes over a part of the page, in pixels, without frame and ticks."""
        bottom = self.height - top - height
        axes = self.figure.add_axes(
            (left / self.width, bottom / self.height, width / self.width, height / self.height)
        )
        axes.set_axis_off()
        return axes

    def add_picture(self, picture: Image.Image, left: int, top: int) -> None:
        """Put `picture` with its upper left corner at a pixel."""
        axes = self.area(left, top, picture.width, picture.height)
        axes.imshow(picture, interpolation="none", aspect="auto")

    def write(self, x: float, y: float, text: str, **style: Any) -> None:
        """Write `text` at a pixel, by default to its right; `style` as for matplotlib's text."""
        options: dict[str, Any] = {"color": INK, "va": "center", "fontsize": LETTERS, **style}
        at = x / self.width, 1 - y / self.height
        self.figure.text(*at, text, parse_math=False, **options)

    def save(self, paths: Sequence[Path]) -> None:
        """Write the page to each of `paths`, in the format of its ending, one of `ENDINGS`."""
        from matplotlib import rc_context

        for path in paths:
            with rc_context(_STYLE), replacing(path) as draft:
                ending = path.suffix.lower()
                self.figure.savefig(
                    draft, format=ending[1:], dpi=DOTS_PER_INCH, metadata=_NO_DATES[ending]
                )


def check_ending(path: Path) -> None:
    """Raise `InputError` if figures cannot be written in the format of the ending of `path`."""
    if path.suffix.lower() not in ENDINGS:
        raise InputError(
            f"figures are written as {' or '.join(ENDINGS)}",
            where=path,
            remedy="Give the file one of these endings",
        )


def pixels(points: float) -> float:
    """Convert `points` to pixels of a page."""
    return points * DOTS_PER_INCH / POINTS_PER_INCH
