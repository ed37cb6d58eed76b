"""Drawn pictures as video frames: averaged down, in BT.709 yuv420p, on the plain background."""

from __future__ import annotations

from typing import Any, Final

import av
import numpy as np
from av.video.reformatter import ColorRange, Colorspace, Interpolation, VideoReformatter
from numpy.typing import NDArray

from renderer.frames import SUPERSAMPLING
from renderer.look import BACKGROUND
from renderer.pixel_box import PixelBox

_PLANE_SHRINKS: Final = (1, 2, 2)
"""How many pixels one sample of each yuv420p plane covers on each side."""


class Canvas:
    """Makes video frames of `size` × `size` pixels from parts of pictures."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._reformatter = VideoReformatter()
        side = 16 * SUPERSAMPLING
        plain = np.full((side, side, 4), (*BACKGROUND, 255), np.uint8)
        sample = self._converted(plain)
        self._background = [int(plane_pixels(plane)[0, 0]) for plane in sample.planes]

    def with_picture(self, picture: NDArray[np.uint8], box: PixelBox) -> Any:
        """Return an `av.VideoFrame` with `picture` in its place.

        Parameters
        ----------
        picture : ndarray, shape (height, width, 4)
            RGBA, `frames.SUPERSAMPLING` times as large as in the video on each side.
        box : PixelBox
            Which part of the whole picture it is; the rest is background.
        """
        part = self._converted(picture)
        if (box.width, box.height) == (self._size * SUPERSAMPLING,) * 2:
            return part
        frame = av.VideoFrame(self._size, self._size, "yuv420p")
        for plane, source, plain, shrink in zip(
            frame.planes, part.planes, self._background, _PLANE_SHRINKS, strict=True
        ):
            pixels, inner = plane_pixels(plane), plane_pixels(source)
            top = box.top // SUPERSAMPLING // shrink
            left = box.left // SUPERSAMPLING // shrink
            pixels[:] = plain
            pixels[top : top + inner.shape[0], left : left + inner.shape[1]] = inner
        return frame

    def _converted(self, picture: NDArray[np.uint8]) -> Any:
        """Return `picture` averaged down in yuv420p."""
        height, width = picture.shape[:2]
        # One call of swscale averages down, converts and subsamples.
        return self._reformatter.reformat(
            av.VideoFrame.from_numpy_buffer(picture, format="rgba"),
            width=width // SUPERSAMPLING,
            height=height // SUPERSAMPLING,
            format="yuv420p",
            interpolation=Interpolation.AREA,
            src_color_range=ColorRange.JPEG,
            dst_color_range=ColorRange.MPEG,
            dst_colorspace=Colorspace.ITU709,
            threads=1,
        )


def plane_pixels(plane: Any) -> NDArray[np.uint8]:
    """Return a plane of a frame as an array that shares its memory, shape (height, width)."""
    rows = np.frombuffer(plane, np.uint8).reshape(-1, plane.line_size)
    return rows[: plane.height, : plane.width]
