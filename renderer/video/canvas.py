"""Drawn pictures as video frames: averaged down, in BT.709 yuv420p, on the plain background."""

from __future__ import annotations

from typing import Any, Final

import av
import numpy as np
from av.video.reformatter import Interpolation, VideoReformatter
from numpy.typing import NDArray

from renderer.frames import SUPERSAMPLING
from renderer.look import BACKGROUND
from renderer.pixel_box import PixelBox
from renderer.video.channels import VIDEO

_PLANE_SHRINKS: Final = (1, 2, 2)
"""How many pixels one sample of each yuv420p plane covers on each side."""


class Canvas:
    """Makes video frames of `size` × `size` pixels from parts of pictures."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._reformatters = [VideoReformatter() for _ in _PLANE_SHRINKS]
        plain = VIDEO @ [*BACKGROUND, 255.0]
        self._background = np.round(plain[:3]).astype(int).tolist()

    def with_picture(self, planes: NDArray[np.uint8], box: PixelBox) -> Any:
        """Return an `av.VideoFrame` with a picture in its place.

        Parameters
        ----------
        planes : ndarray, shape (3, height, width)
            The picture in the channels `renderer.video.channels.VIDEO`, `frames.SUPERSAMPLING`
            times as large as in the video on each side.
        box : PixelBox
            Which part of the whole picture it is; the rest is background.
        """
        frame = av.VideoFrame(self._size, self._size, "yuv420p")
        for number, shrink in enumerate(_PLANE_SHRINKS):
            inner = self._averaged(number, planes[number], SUPERSAMPLING * shrink)
            pixels = plane_pixels(frame.planes[number])
            top = box.top // SUPERSAMPLING // shrink
            left = box.left // SUPERSAMPLING // shrink
            pixels[:] = self._background[number]
            pixels[top : top + inner.shape[0], left : left + inner.shape[1]] = inner
        return frame

    def _averaged(self, number: int, plane: NDArray[np.uint8], times: int) -> NDArray[np.uint8]:
        """Return `plane` with the mean of each `times` × `times` pixels."""
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
