"""The part of a picture that a figure takes up: only that is drawn, read back and converted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

_STEP: Final = 16
"""Boxes begin and end at multiples of this many pixels, so that their chroma samples do too."""

_MARGIN: Final = 8
"""Pixels of background kept round the figure, which averaging down mixes with its edge."""


@dataclass(frozen=True, kw_only=True)
class PixelBox:
    """A rectangle of whole pixels; `left` and `top` count from the picture's upper left corner."""

    left: int
    top: int
    width: int
    height: int

    @classmethod
    def whole(cls, side: int) -> Self:
        """Return the box of a whole square picture."""
        return cls(left=0, top=0, width=side, height=side)

    @classmethod
    def round_all(cls, boxes: Sequence[PixelBox]) -> Self:
        """Return the smallest box that holds all of `boxes`, of which there is at least one."""
        left, top = min(box.left for box in boxes), min(box.top for box in boxes)
        right = max(box.left + box.width for box in boxes)
        bottom = max(box.top + box.height for box in boxes)
        return cls(left=left, top=top, width=right - left, height=bottom - top)

    @classmethod
    def around(
        cls, vertices: NDArray[np.float32], projection: NDArray[np.float64], side: int
    ) -> Self:
        """Return a box round all that `vertices` show in a square picture.

        Parameters
        ----------
        vertices : ndarray, shape (..., 3)
            Positions in metres, of one frame or of several.
        projection : ndarray, shape (4, 4)
            From homogeneous positions to clip space, whose y runs down the picture.
        side : int
            Pixels along each side of the picture.
        """
        flat = projection[[0, 1, 3]].astype(np.float32)
        across, down, depth = flat[:, :3] @ vertices.reshape(-1, 3).T + flat[:, 3:]
        if depth.min() <= 0:
            return cls.whole(side)  # something is behind the camera, and projects anywhere
        left, right = _span(across / depth, side)
        top, bottom = _span(down / depth, side)
        return cls(left=left, top=top, width=right - left, height=bottom - top)


def _span(places: NDArray[np.float32], side: int) -> tuple[int, int]:
    """Return the first pixel, and the one after the last, of `places` in [-1, 1]."""
    low = (float(places.min()) + 1) / 2 * side - _MARGIN
    high = (float(places.max()) + 1) / 2 * side + _MARGIN
    first = int(np.clip(low, 0, side - 1)) // _STEP * _STEP
    end = min(side, -int(-np.clip(high, first + 1, side) // _STEP) * _STEP)
    return first, end
