"""A page as it is printed: pictures with text around them, as PNG and PDF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from motion.errors import InputError
from motion.files import replacing
from renderer.figures.lettering import INK

DOTS_PER_INCH: Final = 300
"""Resolution that journals ask for."""
POINTS_PER_INCH: Final = 72
LETTERS: Final = 8.0
"""Points; as large as captions in two-column papers."""
ENDINGS: Final = (".pdf", ".png")

# Text stays text in a PDF, in letters that a reader can search and an author can edit.
_STYLE: Final[dict[Any, Any]] = {"pdf.fonttype": 42, "font.family": "DejaVu Sans"}
# Without them, the same figure has the same bytes.
_NO_DATES: Final = {
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    ".png": {"Software": None},
}


@dataclass(frozen=True)
class Plate:
    """A page of `width` × `height` pixels at `DOTS_PER_INCH`, first row on top.

    Pictures lie on whole pixels, so that none of them is resampled.
    """

    width: int
    height: int
    figure: Figure

    @classmethod
    def of(cls, width: int, height: int, *, clear: bool) -> Plate:
        """Return an empty page, white or `clear`."""
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
        """Write `text` at a pixel; `style` as for `matplotlib.figure.Figure.text`."""
        given: dict[str, Any] = {"color": INK, "parse_math": False, **style}
        self.figure.text(x / self.width, 1 - y / self.height, text, **given)

    def save(self, paths: Sequence[Path]) -> None:
        """Write the page to each of `paths`, by its ending one of `ENDINGS`."""
        for path in paths:
            check_ending(path)
        for path in paths:
            with mpl.rc_context(_STYLE), replacing(path) as draft:
                ending = path.suffix.lower()
                self.figure.savefig(
                    draft, format=ending[1:], dpi=DOTS_PER_INCH, metadata=_NO_DATES[ending]
                )


def check_ending(path: Path) -> None:
    """Raise `InputError` where a figure cannot be written as what `path` ends with."""
    if path.suffix.lower() not in ENDINGS:
        raise InputError(
            f"figures are written as {' or '.join(ENDINGS)}",
            where=path,
            remedy="Give the file one of these endings",
        )


def pixels(points: float) -> float:
    """Return how many pixels of a page so many `points` are."""
    return points * DOTS_PER_INCH / POINTS_PER_INCH
