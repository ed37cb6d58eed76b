"""Parts of pictures, and their conversion to video frames.

Only the part with the figure is drawn, read back and converted, in three channels: red, green and
blue, or a video's own. It is downsampled and placed on the plain background in BT.709 yuv420p.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Self

import av
import numpy as np
from av.video.reformatter import Interpolation, VideoReformatter
from numpy.typing import NDArray

from motion.arrays import Floats, Floats32
from renderer.look import BACKGROUND, Colour

_RED, _BLUE = 0.2126, 0.0722
_LUMA: Final = np.array([_RED, 1 - _RED - _BLUE, _BLUE])

RGB: Final = np.eye(4)
"""Leaves red, green and blue unchanged."""

VIDEO: Final = np.zeros((4, 4))
"""From red, green, blue and 1 to luma, blue and red difference, and 1, all from 0 to 1.

Rec. ITU-R BT.709-6, items 3.2 to 3.4, in the 8-bit levels 16 to 235 and 16 to 240. It is linear, so
that a vertex shader can apply it and only averaging remains.
"""
VIDEO[0, :3] = 219 / 255 * _LUMA
VIDEO[1, :3] = 224 / 255 * ([0, 0, 1] - _LUMA) / (2 * (1 - _BLUE))
VIDEO[2, :3] = 224 / 255 * ([1, 0, 0] - _LUMA) / (2 * (1 - _RED))
VIDEO[:3, 3] = np.array([16, 128, 128]) / 255
VIDEO[3, 3] = 1

SUPERSAMPLING: Final = 2
"""Factor by which each side of a frame is drawn larger before downsampling."""

_STEP: Final = 16
"""Boxes start and end at multiples of this many pixels, so that their chroma samples do too."""

_MARGIN: Final = 8
"""Pixels of background around the figure, which downsampling blends with its edge."""

_PLANE_SCALES: Final = (1, 2, 2)
"""Pixels per sample of each yuv420p plane on each side."""


@dataclass(frozen=True, kw_only=True)
class PixelBox:
    """A rectangle of whole pixels; `left` and `top` count from the picture's upper left corner."""

    left: int
    top: int
    width: int
    height: int

    @classmethod
    def full(cls, side: int) -> Self:
        """Return the box of a whole square picture."""
        return cls(left=0, top=0, width=side, height=side)

    @classmethod
    def union(cls, boxes: Sequence[PixelBox]) -> Self:
        """Return the smallest box that contains all of `boxes`; there must be at least one."""
        left, top = min(box.left for box in boxes), min(box.top for box in boxes)
        right = max(box.left + box.width for box in boxes)
        bottom = max(box.top + box.height for box in boxes)
        return cls(left=left, top=top, width=right - left, height=bottom - top)

    @classmethod
    def around(cls, vertices: Floats32, projection: Floats, side: int) -> Self:
        """Return the bounding box of `vertices` in a square picture.

        Parameters
        ----------
        vertices : ndarray, shape (..., 3)
            Positions in metres, of one frame or of several.
        projection : ndarray, shape (4, 4)
            Matrix from homogeneous positions to clip space, with y down.
        side : int
            Pixels along each side of the picture.
        """
        flat = projection[[0, 1, 3]].astype(np.float32)
        x, y, depth = flat[:, :3] @ vertices.reshape(-1, 3).T + flat[:, 3:]
        if depth.min() <= 0:
            return cls.full(side)  # a vertex behind the camera may project anywhere
        left, right = _span(x / depth, side)
        top, bottom = _span(y / depth, side)
        return cls(left=left, top=top, width=right - left, height=bottom - top)


def _span(positions: Floats32, side: int) -> tuple[int, int]:
    """Return the first pixel, and the one after the last, of `positions` in [-1, 1]."""
    low = (float(positions.min()) + 1) / 2 * side - _MARGIN
    high = (float(positions.max()) + 1) / 2 * side + _MARGIN
    first = int(np.clip(low, 0, side - 1)) // _STEP * _STEP
    end = min(side, -int(-np.clip(high, first + 1, side) // _STEP) * _STEP)
    return first, end


class Canvas:
    """Converts parts of pictures to video frames of `size` × `size` pixels."""

    def __init__(self, size: int, background: Colour = BACKGROUND) -> None:
        self._size = size
        self._reformatters = [VideoReformatter() for _ in _PLANE_SCALES]
        colour = VIDEO @ [*background, 255.0]
        self._background = np.round(colour[:3]).astype(int).tolist()

    def video_frame(self, planes: NDArray[np.uint8], box: PixelBox) -> Any:
        """Return an `av.VideoFrame` with a part of a picture at its position.

        Parameters
        ----------
        planes : ndarray, shape (3, height, width)
            The picture in the channels `VIDEO`, `SUPERSAMPLING` times as large as in the video on
            each side.
        box : PixelBox
            Position of the part in the whole picture; the remainder is background.
        """
        frame = av.VideoFrame(self._size, self._size, "yuv420p")
        for number, shrink in enumerate(_PLANE_SCALES):
            inner = self._averaged(number, planes[number], SUPERSAMPLING * shrink)
            pixels = plane_pixels(frame.planes[number])
            top = box.top // SUPERSAMPLING // shrink
            left = box.left // SUPERSAMPLING // shrink
            pixels[:] = self._background[number]
            pixels[top : top + inner.shape[0], left : left + inner.shape[1]] = inner
        return frame

    def _averaged(self, number: int, plane: NDArray[np.uint8], times: int) -> NDArray[np.uint8]:
        """Return `plane` downsampled by the mean of each `times` × `times` pixels."""
        height, width = plane.shape
        smaller = self._reformatters[number].reformat(
            av.VideoFrame.from_numpy_buffer(plane, format="gray"),
            width=width // times,
            height=height // times,
            interpolation=Interpolation.AREA,
            threads=1,
        )
        return plane_pixels(smaller.planes[0])


def plane_pixels(plane: Any) -> NDArray[np.uint8]:
    """Return a plane of a frame as an array that shares its memory, shape (height, width)."""
    rows = np.frombuffer(plane, np.uint8).reshape(-1, plane.line_size)
    return rows[: plane.height, : plane.width]
