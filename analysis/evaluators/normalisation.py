"""Putting channels of very different size on one scale, as they were recorded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float32]


@dataclass(frozen=True, kw_only=True, eq=False)
class Normalisation:
    """Mean and spread of each channel over all recorded frames.

    Attributes
    ----------
    mean, deviation : ndarray, shape (C,), float32
        In the channels' own units; a deviation is never below the floor it was made with.
    """

    mean: FloatArray
    deviation: FloatArray

    @classmethod
    def of(cls, clips: Sequence[FloatArray], *, floor: FloatArray) -> Normalisation:
        """Return the normalisation of recorded frames.

        Parameters
        ----------
        clips : sequence of ndarray, shape (T, C)
            At least one frame in all.
        floor : ndarray, shape (C,)
            Least deviation of each channel, in its unit: what hardly ever moved is not blown up.
        """
        frames = sum(len(clip) for clip in clips)
        mean = sum(clip.sum(axis=0, dtype=np.float64) for clip in clips) / frames
        squares = sum(((clip - mean) ** 2).sum(axis=0) for clip in clips)
        deviation = np.maximum(np.sqrt(squares / frames), floor)
        return cls(mean=np.asarray(mean, np.float32), deviation=np.asarray(deviation, np.float32))

    def __call__(self, frames: FloatArray) -> FloatArray:
        """Return frames, shape (T, C), in standard deviations from the mean."""
        return np.asarray((frames - self.mean) / self.deviation, np.float32)
