"""How recorded motion is spread, against which generated motion is normalised."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

_STILL: Final = 1e-4
"""Radians of standard deviation below which a channel does not move."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ClipExtent:
    """What one recording adds to the spread of all.

    Attributes
    ----------
    frames : int
        Frames of the clip.
    total, squares : ndarray, shape (J, 3)
        Sums of rotations, and of their squares, over frames.
    low, high : ndarray, shape (3,)
        Opposite corners of the box in which all joints stay, in metres.
    """

    frames: int
    total: FloatArray
    squares: FloatArray
    low: FloatArray
    high: FloatArray

    @classmethod
    def of(cls, rotations: FloatArray, positions: FloatArray) -> ClipExtent:
        """Return the extent of rotations and positions of shape (T, J, 3), (T, P, 3)."""
        return cls(
            frames=len(rotations),
            total=rotations.sum(axis=0),
            squares=(rotations**2).sum(axis=0),
            low=positions.min(axis=(0, 1)),
            high=positions.max(axis=(0, 1)),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedSpread:
    """Mean and spread of rotations, and the scale of positions, of all recordings together.

    Attributes
    ----------
    mean, deviation : ndarray, shape (J, 3)
        Of axis-angle channels, in radians; the deviation of a channel that never moves is 1.
    moving : ndarray, shape (J,), bool
        Joints of which any channel moves.
    scale : float
        Puts all recorded joints into a box of one metre diagonal.
    recordings : int
        How many there are.
    """

    mean: FloatArray
    deviation: FloatArray
    moving: NDArray[np.bool_]
    scale: float
    recordings: int

    def normalised(self, rotations: FloatArray) -> FloatArray:
        """Return rotations of shape (T, J, 3) in standard deviations, of moving joints alone."""
        standard = (rotations - self.mean) / self.deviation
        return np.asarray(standard[:, self.moving])


def recorded_spread(extents: Iterable[ClipExtent]) -> RecordedSpread | None:
    """Return the spread of recordings; None for no recording, or one of a single point."""
    found = list(extents)
    if not found:
        return None
    frames = sum(extent.frames for extent in found)
    mean = sum(extent.total for extent in found) / frames
    squares = sum(extent.squares for extent in found) / frames
    # Rotations are near 1, so that squares lose nothing that `_STILL` would see.
    deviation = np.sqrt(np.maximum(0, squares - mean**2))
    moves = deviation > _STILL
    low = np.min([extent.low for extent in found], axis=0)
    high = np.max([extent.high for extent in found], axis=0)
    diagonal = float(np.linalg.norm(high - low))
    if not diagonal > 0:
        return None
    return RecordedSpread(
        mean=np.asarray(mean),
        deviation=np.where(moves, deviation, 1.0),
        moving=np.asarray(moves.any(axis=1)),
        scale=1 / diagonal,
        recordings=len(found),
    )
