"""A contact sheet: every stimulus of a study at a glance, as one HTML page.

Each cell is one small picture of a video.
"""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from PIL import Image, ImageDraw

from motion.segment import Segment
from renderer.figures.glance import MOMENTS, TILE_SIZE, Glance
from renderer.figures.plate import FAINT_INK, font
from renderer.look import BACKGROUND

COLUMNS: Final = 4
CURVE: Final = 30
"""Pixels of the movement curve's height."""
CELL: Final = (COLUMNS * TILE_SIZE, (MOMENTS + 1) // COLUMNS * TILE_SIZE + CURVE)
"""Width and height of a cell in pixels."""

_FULL_CURVE: Final = 40.0
_CURVE_COLOUR: Final = (0x00, 0x72, 0xB2)
_PRESENCE_COLOUR: Final = np.array((0x00, 0x44, 0x77))
_DESCRIPTION: Final = 0x010E  # EXIF's ImageDescription


@dataclass(frozen=True, kw_only=True)
class SheetCell:
    """A cell of the sheet with its remark and link.

    Attributes
    ----------
    cell : Cell or None
        None if there is no readable video.
    remark : str
        Points worth a look, or why there is no picture.
    video : str
        Address of the video from the HTML page; empty where there is none.
    """

    cell: Cell | None
    remark: str
    video: str


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """The whole sheet.

    Attributes
    ----------
    title : str
        The study's title.
    facts : str
        What all videos share, in words.
    conditions : tuple of str
        Columns.
    roles : mapping of str to str
        A condition's role in the study, if it should be shown.
    segments : tuple of Segment
        Rows.
    cells : mapping of (segment, condition) to SheetCell
        By name.
    motion : mapping of str to str
        Address, relative to the HTML page, of a page that shows a segment's motion in 3D.
    """

    title: str
    facts: str
    conditions: tuple[str, ...]
    roles: Mapping[str, str]
    segments: tuple[Segment, ...]
    cells: Mapping[tuple[str, str], SheetCell]
    motion: Mapping[str, str] = field(default_factory=dict)


def sheet_page(sheet: Sheet) -> str:
    """Return the sheet as one HTML page that needs no other file but those that it links to."""
    templates = Environment(
        loader=PackageLoader("renderer", "figures"),
        undefined=StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return templates.get_template("sheet.html").render(
        sheet=sheet, width=CELL[0], height=CELL[1], address=_data_address
    )


def _data_address(cell: Cell) -> str:
    """Return a cell's picture as a data address."""
    return "data:image/webp;base64," + base64.b64encode(cell.data).decode()


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
    def remarks(self) -> tuple[str, ...]:
        """Remarks on the video."""
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
    letters = font(TILE_SIZE * 0.095)
    for number, (seconds, picture) in enumerate(zip(glance.times, glance.pictures, strict=True)):
        place = number % COLUMNS * TILE_SIZE, number // COLUMNS * TILE_SIZE
        image.paste(Image.fromarray(picture), place)
        pen.text((place[0] + 4, place[1] + 3), f"{seconds:.1f}", FAINT_INK, letters)
    image.paste(_presence(glance), ((COLUMNS - 1) * TILE_SIZE, CELL[1] - CURVE - TILE_SIZE))
    _draw_curve(pen, glance)
    remarks = Image.Exif()
    remarks[_DESCRIPTION] = json.dumps(glance.remarks)
    data = io.BytesIO()
    image.save(data, "WEBP", quality=82, method=4, exif=remarks)
    return Cell(data.getvalue())


def _presence(glance: Glance) -> Image.Image:
    """Return a map of the figure's positions: darker if longer."""
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
