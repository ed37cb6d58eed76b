"""A contact sheet: every stimulus of a study at a glance, as one HTML page and as PNG pages."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from jinja2 import Environment, PackageLoader, StrictUndefined
from PIL import Image, ImageDraw

from motion.segment import Segment
from renderer.figures.lettering import FAINT_INK, INK, font, wrapped
from renderer.figures.sheet_cell import CELL, Cell

ROWS_ON_PAGE: Final = 10

_MARGIN: Final = 24
_NAMES_WIDTH: Final = 300
_LINE: Final = 24
_LETTERS: Final = 17
_HEADER: Final = 84
_REMARK_COLOUR: Final = (0xB0, 0x45, 0x00)
_CELL_HEIGHT: Final = CELL[1] + _LINE + 10


@dataclass(frozen=True, kw_only=True)
class SheetCell:
    """What stands in a cell of the sheet.

    Attributes
    ----------
    cell : Cell or None
        None where there is no video that can be read.
    remark : str
        What is worth a look; why there is no picture where there is none.
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
        What a condition is in the study, where that is to be said.
    segments : tuple of Segment
        Rows.
    cells : mapping of (segment, condition) to SheetCell
        By name.
    """

    title: str
    facts: str
    conditions: tuple[str, ...]
    roles: Mapping[str, str]
    segments: tuple[Segment, ...]
    cells: Mapping[tuple[str, str], SheetCell]


def sheet_page(sheet: Sheet) -> str:
    """Return the sheet as one HTML page that needs no other file but the videos it links to."""
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


def sheet_pictures(sheet: Sheet) -> Iterator[Image.Image]:
    """Yield the sheet as pictures of `ROWS_ON_PAGE` segments each."""
    pages = [
        sheet.segments[first : first + ROWS_ON_PAGE]
        for first in range(0, len(sheet.segments), ROWS_ON_PAGE)
    ]
    for number, rows in enumerate(pages, 1):
        yield _page(sheet, rows, f"{sheet.facts}; page {number} of {len(pages)}")


def _data_address(cell: Cell) -> str:
    """Return a cell's picture as the address of itself."""
    return "data:image/webp;base64," + base64.b64encode(cell.data).decode()


def _page(sheet: Sheet, rows: Sequence[Segment], facts: str) -> Image.Image:
    """Return one page with some of the segments."""
    width = _NAMES_WIDTH + len(sheet.conditions) * (CELL[0] + _MARGIN) + _MARGIN
    image = Image.new("RGB", (width, _HEADER + len(rows) * _CELL_HEIGHT + _MARGIN), "white")
    pen = ImageDraw.Draw(image)
    pen.text((_MARGIN, 14), sheet.title, INK, font(_LETTERS, bold=True))
    pen.text((_MARGIN, 14 + _LINE), facts, FAINT_INK, font(_LETTERS * 0.85))
    for column, condition in enumerate(sheet.conditions):
        left = _NAMES_WIDTH + column * (CELL[0] + _MARGIN)
        letters = font(_LETTERS, bold=True)
        pen.text((left, _HEADER - _LINE), condition, INK, letters)
        role = sheet.roles.get(condition, "")
        beside = left + letters.getlength(condition) + 8
        pen.text((beside, _HEADER - _LINE), role, FAINT_INK, font(_LETTERS))
    for row, segment in enumerate(rows):
        top = _HEADER + row * _CELL_HEIGHT
        _write_segment(pen, segment, top)
        for column, condition in enumerate(sheet.conditions):
            left = _NAMES_WIDTH + column * (CELL[0] + _MARGIN)
            _paste_cell(image, pen, sheet.cells[segment.name, condition], left, top)
    return image


def _write_segment(pen: ImageDraw.ImageDraw, segment: Segment, top: int) -> None:
    """Write what a row's speech is."""
    small = font(_LETTERS * 0.85)
    room = _NAMES_WIDTH - 2 * _MARGIN
    lines = wrapped(segment.name, font(_LETTERS, bold=True), room, 1)
    pen.text((_MARGIN, top), lines[0], INK, font(_LETTERS, bold=True))
    facts = f"{segment.emotion}, {segment.speaker}, {segment.duration:.1f} s"
    for line, text in enumerate(wrapped(facts, small, room, 2), 1):
        pen.text((_MARGIN, top + line * _LINE), text, FAINT_INK, small)
    for line, text in enumerate(wrapped(segment.transcript, small, room, 6), 3):
        pen.text((_MARGIN, top + line * _LINE), text, INK, small)


def _paste_cell(
    image: Image.Image, pen: ImageDraw.ImageDraw, entry: SheetCell, left: int, top: int
) -> None:
    """Put a cell and its remark on a page; a frame stands for a picture that is not there."""
    if entry.cell is not None:
        image.paste(entry.cell.picture, (left, top))
    else:
        pen.rectangle((left, top, left + CELL[0], top + CELL[1]), outline=_REMARK_COLOUR, width=2)
    small = font(_LETTERS * 0.85)
    for text in wrapped(entry.remark, small, CELL[0], 1):
        pen.text((left, top + CELL[1] + 3), text, _REMARK_COLOUR, small)
