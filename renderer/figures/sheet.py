"""A contact sheet: every stimulus of a study at a glance, as one HTML page.

Each cell is a small picture of a rendered video: some of its moments, a map of the figure's
positions, and a curve of its movement.
"""

import base64
import io
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import av
import numpy as np
from av.video.frame import VideoFrame
from av.video.reformatter import ColorRange, Interpolation, VideoReformatter
from jinja2 import Environment, PackageLoader, StrictUndefined
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from motion.arrays import Bools, Floats, Floats32
from motion.errors import InputError
from motion.segment import Segment
from renderer.figures.plate import FAINT_INK, font
from renderer.look import BACKGROUND, Look

MOMENTS: Final = 7
TILE_SIZE: Final = 112
"""Pixels along each side of a small picture."""

_COLUMNS: Final = 4
_CURVE: Final = 30
"""Pixels of the movement curve's height."""
_CELL: Final = (_COLUMNS * TILE_SIZE, (MOMENTS + 1) // _COLUMNS * TILE_SIZE + _CURVE)
"""Width and height of a cell in pixels."""

_FULL_CURVE: Final = 40.0
_CURVE_COLOUR: Final = (0x00, 0x72, 0xB2)
_PRESENCE_COLOUR: Final = np.array((0x00, 0x44, 0x77))
_DESCRIPTION: Final = 0x010E  # EXIF's ImageDescription


@dataclass(frozen=True, kw_only=True)
class SheetCell:
    """A cell of the sheet.

    Attributes
    ----------
    picture : bytes or None
        The picture of `draw_cell`; None if there is no readable video.
    remark : str
        Remarks on the video, or why there is no picture.
    video : str
        Address of the video, relative to the HTML page; empty if there is none.
    """

    picture: bytes | None
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
        The common properties of all videos, in words.
    conditions : tuple of str
        The conditions, one per column.
    roles : mapping of str to str
        A condition's role in the study, if it should be shown.
    segments : tuple of Segment
        The segments, one per row.
    cells : mapping of (segment, condition) to SheetCell
        The cells, by names of segment and condition.
    motion : mapping of str to str
        For each segment, the address of a page that shows its motion in 3D, relative to the HTML
        page.
    """

    title: str
    facts: str
    conditions: tuple[str, ...]
    roles: Mapping[str, str]
    segments: tuple[Segment, ...]
    cells: Mapping[tuple[str, str], SheetCell]
    motion: Mapping[str, str] = field(default_factory=dict)


def sheet_page(sheet: Sheet) -> str:
    """Return the sheet as an HTML page that needs no other files than those that it links to."""
    templates = Environment(
        loader=PackageLoader("renderer", "figures"),
        undefined=StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return templates.get_template("sheet.html").render(
        sheet=sheet, width=_CELL[0], height=_CELL[1], address=_data_address
    )


def _data_address(picture: bytes) -> str:
    return "data:image/webp;base64," + base64.b64encode(picture).decode()


_LUMA_WEIGHTS: Final = np.array([0.2126, 0.7152, 0.0722], np.float32)
"""Weights of RGB in a pixel's lightness."""
_FIGURE_CONTRAST: Final = 10
"""Difference from the background, of 255, above which pixels belong to the figure."""
_STILL_CHANGE: Final = 2.5
"""Largest change of a thumbnail's pixels between frames by encoding alone, of 255."""
_STILL_SECONDS: Final = 1.0
_JUMP_CHANGE: Final = 30.0
_RESTLESS_CHANGE: Final = 20.0
"""Mean change of the figure's thumbnail pixels between frames at 30 frames per second, of 255.
Gesturing speakers have a median of 1 to 5 and rarely exceed 20; a deliberately broken clip has
40."""
_EMPTY_SHARE: Final = 0.02
_OUTSIDE_SHARE: Final = 0.02
_RATE: Final = 30.0


@dataclass(frozen=True, eq=False)
class Glance:
    """A summary of one video.

    Attributes
    ----------
    times : tuple of float
        The moments in seconds, `MOMENTS` of them, evenly spaced.
    pictures : ndarray, shape (MOMENTS, SIDE, SIDE, 3), uint8
        RGB at these moments.
    presence : ndarray, shape (SIDE, SIDE), float32
        Share of the frames in which the figure was at each place.
    movement : ndarray, shape (T - 1,), float32
        Mean change of the figure's pixels from frame to frame, of 255.
    remarks : tuple of str
        Remarks on stillness, jumps, or a figure that leaves the picture.
    """

    times: tuple[float, ...]
    pictures: NDArray[np.uint8]
    presence: Floats32
    movement: Floats32
    remarks: tuple[str, ...]


def glance_at(video: Path, look: Look | None = None) -> Glance:
    """Return a summary of a video of a figure in front of a plain background.

    Parameters
    ----------
    video : Path
        The video of one clip.
    look : Look or None
        Its look; None for the default.

    Raises
    ------
    InputError
        If it cannot be read as a video.
    """
    with pictures_of(video) as stream:
        rate, reformatter = float(stream.average_rate or _RATE), VideoReformatter()
        size = (TILE_SIZE, TILE_SIZE)
        small = (
            small_picture(reformatter, frame, size) for frame in stream.container.decode(stream)
        )
        frames = np.stack(list(small))
    count = len(frames)
    used_look = look or Look()
    moments = [int((place + 0.5) * count / MOMENTS) for place in range(MOMENTS)]
    luma = frames @ _LUMA_WEIGHTS
    figure = np.abs(luma - round(float(_LUMA_WEIGHTS @ used_look.background))) > _FIGURE_CONTRAST
    change = np.abs(np.diff(luma, axis=0))
    either = figure[1:] | figure[:-1]
    movement = (change * either).sum(axis=(1, 2)) / np.maximum(either.sum(axis=(1, 2)), 1)
    largest = np.percentile(change, 99.8, axis=(1, 2)) if count > 1 else np.zeros(0)
    return Glance(
        times=tuple(round(frame / rate, 3) for frame in moments),
        pictures=frames[moments],
        presence=figure.mean(axis=0, dtype=np.float32),
        movement=movement.astype(np.float32),
        remarks=(
            *_stillness(largest <= _STILL_CHANGE, rate),
            *_restlessness(movement * rate / _RATE, rate),
            *_absence(figure, cropped=used_look.framing in ("face", "hands")),
        ),
    )


@contextmanager
def pictures_of(video: Path) -> Iterator[Any]:
    """Yield the pictures of a video as a stream; `InputError` if it cannot be read."""
    try:
        with av.open(str(video)) as container:
            yield container.streams.video[0]
    except (av.FFmpegError, OSError, IndexError, ValueError) as error:
        raise InputError(
            "the video cannot be read", where=video, remedy="Delete it and render again"
        ) from error


def small_picture(
    reformatter: VideoReformatter, frame: VideoFrame, size: tuple[int, int]
) -> NDArray[np.uint8]:
    """Return a frame as RGB with the width and height `size`."""
    small = reformatter.reformat(
        frame,
        width=size[0],
        height=size[1],
        format="rgb24",
        interpolation=Interpolation.AREA,
        src_color_range=ColorRange.MPEG,
        dst_color_range=ColorRange.JPEG,
    )
    return np.asarray(small.to_ndarray(), np.uint8)


def _stillness(is_still: Bools, rate: float) -> Iterator[str]:
    """Yield remarks on times without motion, `_STILL_SECONDS` or longer."""
    if is_still.all():
        yield "never moves"
        return
    edges = np.diff(np.concatenate([[0], is_still.astype(int), [0]]))
    for start, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        if (end - start) / rate >= _STILL_SECONDS:
            yield f"still from {start / rate:.1f} to {end / rate:.1f} s"


def _restlessness(movement: Floats, rate: float) -> Iterator[str]:
    """Yield a remark if the motion jerks throughout or jumps."""
    if not len(movement):
        return
    if np.median(movement) > _RESTLESS_CHANGE:
        yield "jerks throughout"
        return
    jumps = np.flatnonzero(movement > _JUMP_CHANGE)
    if len(jumps):
        times = ", ".join(f"{(jump + 1) / rate:.1f}" for jump in jumps[:3])
        yield f"jumps at {times} s" + (f" and {len(jumps) - 3} more times" * (len(jumps) > 3))


def _absence(figure: Bools, *, cropped: bool) -> Iterator[str]:
    """Yield remarks if the figure is missing or extends beyond an edge other than the lower one.

    If only a part of the body is framed, it may extend beyond any edge.
    """
    is_empty = figure.mean(axis=(1, 2)) < _EMPTY_SHARE
    if is_empty.any():
        yield f"nobody in the picture {np.mean(is_empty):.0%} of the time"
    is_outside = figure[:, 0].any(axis=1) | figure[:, :, [0, -1]].any(axis=(1, 2))
    if not cropped and np.mean(is_outside) > _OUTSIDE_SHARE:
        yield f"out of the picture {np.mean(is_outside):.0%} of the time"


def draw_cell(glance: Glance) -> bytes:
    """Return the picture of a video's cell as a WebP file, which also holds the remarks.

    Rows show the moments with their times. The last tile is darker where the figure was longer. The
    curve below is the movement over time, on the same scale in all cells: a still figure has a flat
    curve.
    """
    image = Image.new("RGB", _CELL, BACKGROUND)
    pen = ImageDraw.Draw(image)
    letters = font(TILE_SIZE * 0.095)
    for number, (seconds, picture) in enumerate(zip(glance.times, glance.pictures, strict=True)):
        place = number % _COLUMNS * TILE_SIZE, number // _COLUMNS * TILE_SIZE
        image.paste(Image.fromarray(picture), place)
        pen.text((place[0] + 4, place[1] + 3), f"{seconds:.1f}", FAINT_INK, letters)
    image.paste(_presence(glance), ((_COLUMNS - 1) * TILE_SIZE, _CELL[1] - _CURVE - TILE_SIZE))
    _draw_curve(pen, glance)
    remarks = Image.Exif()
    remarks[_DESCRIPTION] = json.dumps(glance.remarks)
    data = io.BytesIO()
    image.save(data, "WEBP", quality=82, method=4, exif=remarks)
    return data.getvalue()


def remarks_of(picture: bytes) -> tuple[str, ...]:
    """Return the remarks on the video that `draw_cell` stored in its picture."""
    with Image.open(io.BytesIO(picture)) as image:
        return tuple(json.loads(image.getexif()[_DESCRIPTION]))


def _presence(glance: Glance) -> Image.Image:
    """Return a map of the figure's positions: darker if longer."""
    strength = np.where(glance.presence > 0, 0.12 + 0.78 * glance.presence, 0)[..., None]
    colours = (1 - strength) * np.array(BACKGROUND) + strength * _PRESENCE_COLOUR
    return Image.fromarray(np.round(colours).astype(np.uint8))


def _draw_curve(pen: ImageDraw.ImageDraw, glance: Glance) -> None:
    """Draw the square root of the movement along the bottom, so that small movements show, too."""
    width, height = _CELL
    room = _CURVE - 4
    pen.rectangle((0, height - _CURVE, width, height), fill=(255, 255, 255))
    if not len(glance.movement):
        return
    columns = np.arange(width) * len(glance.movement) // width
    share = np.sqrt(np.minimum(glance.movement[columns] / _FULL_CURVE, 1))
    for x, level in enumerate(share):
        pen.line((x, height - 1, x, height - 1 - round(float(level) * room)), fill=_CURVE_COLOUR)
