"""Between a network's values, of mean 0 and variance 1, and the motion's own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

_LARGEST_ROUNDING: Final = 1e-6
"""Standard deviations below this are rounding: such a value never changes."""


SMALLEST_DEVIATION: Final = 1e-5
"""Smallest deviation that `mean_and_deviation` and `spread` return, of constant values."""


def mean_and_deviation(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard deviation of each of values (N, values)."""
    return values.mean(axis=0), np.maximum(values.std(axis=0), SMALLEST_DEVIATION)


def spread(values: FloatArray) -> float:
    """Return the spread of values (N, values) around their means, all together."""
    return float(np.maximum(np.sqrt(values.var(axis=0).mean()), SMALLEST_DEVIATION))


@dataclass(frozen=True, eq=False)
class Normalisation:
    """Mean and standard deviation of each value of a frame, the body's first.

    Attributes
    ----------
    mean, std : ndarray, shape (values,)
        A value with a zero `std` is constant.
    """

    mean: FloatArray
    std: FloatArray

    def normalised(self, motion: FloatArray) -> FloatArray:
        """Return `motion` (T, values) as a network sees it; constant values are 0."""
        varies = self._varies
        return np.asarray((motion - self.mean) * varies / np.where(varies, self.std, 1.0))

    def restored(self, normalised: FloatArray) -> FloatArray:
        """Return motion (T, values) in its own units; constant values are their mean."""
        return np.asarray(self.mean + np.where(self._varies, self.std, 0.0) * normalised)

    @property
    def _varies(self) -> NDArray[np.bool_]:
        return np.asarray(self.std >= _LARGEST_ROUNDING)
