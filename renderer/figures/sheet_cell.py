"""One cell of a contact sheet: a video at a glance as one small picture."""

from __future__ import annotations

import io
import json
from dataclasses import dataclass
from typing import Final

import numpy as np
from PIL import Image, ImageDraw

from renderer.figures.glance import MOMENTS, SIDE, Glance
from renderer.figures.lettering import FAINT_INK, font
from renderer.look import BACKGROUND

COLUMNS: Final = 4
CURVE: Final = 30
"""Pixels of the movement curve's height."""
CELL: Final = (COLUMNS * SIDE, (MOMENTS + 1) // COLUMNS * SIDE + CURVE)
"""Width and height of a cell in pixels."""

_FULL_CURVE: Final = 40.0
_CURVE_COLOUR: Final = (0x00, 0x72, 0xB2)
_PRESENCE_COLOUR: Final = np.array((0x00, 0x44, 0x77))
_DESCRIPTION: Final = 0x010E  # EXIF's ImageDescription


@dataclass(frozen=True)
class Cell:
    """A cell.

    Attributes
    ----------
    data : bytes
        Its picture as a WebP file that holds the remarks too.
    """

    data: bytes

    @property
    def picture(self) -> Image.Image:
        """The picture, as RGB of `CELL` pixels."""
        with Image.open(io.BytesIO(self.data)) as image:
            return image.convert("RGB")

    @property
    def remarks(self) -> tuple[str, ...]:
        """What is worth a look in the video."""
        with Image.open(io.BytesIO(self.data)) as image:
            return tuple(json.loads(image.getexif()[_DESCRIPTION]))


def draw_cell(glance: Glance) -> Cell:
    """Return the cell of a video.

    Its moments run in rows with their seconds; the last tile is darker the longer the figure was
    there; the curve below is the movement over time, on one scale for all cells, so that a still
    figure has a flat one.
    """
    image = Image.new("RGB", CELL, BACKGROUND)
    pen = ImageDraw.Draw(image)
    letters = font(SIDE * 0.095)
    for number, (seconds, picture) in enumerate(zip(glance.times, glance.pictures, strict=True)):
        place = number % COLUMNS * SIDE, number // COLUMNS * SIDE
        image.paste(Image.fromarray(picture), place)
        pen.text((place[0] + 4, place[1] + 3), f"{seconds:.1f}", FAINT_INK, letters)
    image.paste(_presence(glance), ((COLUMNS - 1) * SIDE, CELL[1] - CURVE - SIDE))
    _draw_curve(pen, glance)
    remarks = Image.Exif()
    remarks[_DESCRIPTION] = json.dumps(glance.remarks)
    data = io.BytesIO()
    image.save(data, "WEBP", quality=82, method=4, exif=remarks)
    return Cell(data.getvalue())


def _presence(glance: Glance) -> Image.Image:
    """Return where the figure was: darker where it was longer."""
    strength = np.where(glance.presence > 0, 0.12 + 0.78 * glance.presence, 0)[..., None]
    colours = (1 - strength) * np.array(BACKGROUND) + strength * _PRESENCE_COLOUR
    return Image.fromarray(np.round(colours).astype(np.uint8))


def _draw_curve(pen: ImageDraw.ImageDraw, glance: Glance) -> None:
    """Draw the movement as an area along the bottom, by its root, so that little shows too."""
    width, height = CELL
    room = CURVE - 4
    pen.rectangle((0, height - CURVE, width, height), fill=(255, 255, 255))
    if not len(glance.movement):
        return
    columns = np.arange(width) * len(glance.movement) // width
    share = np.sqrt(np.minimum(glance.movement[columns] / _FULL_CURVE, 1))
    for x, tall in enumerate(share):
        pen.line((x, height - 1, x, height - 1 - round(float(tall) * room)), fill=_CURVE_COLOUR)
