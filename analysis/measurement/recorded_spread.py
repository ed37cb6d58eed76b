"""Mean and spread of recorded motion, by which generated motion is normalised."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from analysis.metrics.point_errors import box_scale
from motion.arrays import Bools, Floats

_STILL: Final = 1e-4
"""Radians of standard deviation below which a channel does not move."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ClipExtent:
    """The contribution of one recording to the spread of all.

    Attributes
    ----------
    frames : int
        Frames of the clip.
    total, squares : ndarray, shape (J, 3)
        Sums of rotations, and of their squares, over frames.
    box : ndarray, shape (2, 3)
        Opposite corners of the box around all joints, in metres.
    face_box : ndarray, shape (2, 3), or None
        The same for face landmarks; None for a recording without a face.
    """

    frames: int
    total: Floats
    squares: Floats
    box: Floats
    face_box: Floats | None = None

    @classmethod
    def of(
        cls, rotations: Floats, positions: Floats, landmarks: Floats | None = None
    ) -> ClipExtent:
        """Return the extent of one recording.

        Parameters
        ----------
        rotations, positions, landmarks : ndarray, shape (T, J, 3), (T, P, 3), (U, L, 3)
            Rotations and positions of joints, and the landmarks of the face if it has one.
        """
        return cls(
            frames=len(rotations),
            total=rotations.sum(axis=0),
            squares=(rotations**2).sum(axis=0),
            box=_box(positions),
            face_box=None if landmarks is None else _box(landmarks),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedSpread:
    """Mean and spread of rotations, and the scale of positions, of all recordings together.

    Attributes
    ----------
    mean, deviation : ndarray, shape (J, 3)
        Mean and standard deviation of axis-angle channels, in radians; 1 for channels that never
        move.
    moving : ndarray, shape (J,), bool
        Joints with any channel that moves.
    scale : float
        Fits all recorded joints into a box with a diagonal of one metre.
    face_scale : float
        The same for face landmarks; NaN if no recording has a face.
    """

    mean: Floats
    deviation: Floats
    moving: Bools
    scale: float
    face_scale: float

    def normalised(self, rotations: Floats) -> Floats:
        """Return rotations of shape (T, J, 3) in standard deviations, for moving joints only."""
        standard = (rotations - self.mean) / self.deviation
        return np.asarray(standard[:, self.moving])


def recorded_spread(extents: Iterable[ClipExtent]) -> RecordedSpread | None:
    """Return the spread of recordings; None without recordings, or if all points coincide."""
    extents = list(extents)
    if not extents:
        return None
    frames = sum(extent.frames for extent in extents)
    mean = sum(extent.total for extent in extents) / frames
    squares = sum(extent.squares for extent in extents) / frames
    # Rotations are near 1, so the squares lose no precision at the scale of `_STILL`.
    deviation = np.sqrt(np.maximum(0, squares - mean**2))
    moves = deviation > _STILL
    scale = box_scale(extent.box for extent in extents)
    if math.isnan(scale):
        return None
    return RecordedSpread(
        mean=np.asarray(mean),
        deviation=np.where(moves, deviation, 1.0),
        moving=np.asarray(moves.any(axis=1)),
        scale=scale,
        face_scale=box_scale(extent.face_box for extent in extents if extent.face_box is not None),
    )


def _box(points: Floats) -> Floats:
    return np.stack([points.min(axis=(0, 1)), points.max(axis=(0, 1))])
