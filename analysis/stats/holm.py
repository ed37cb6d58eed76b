"""Holm's correction of a declared family of tests."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def holm(p_values: Sequence[float]) -> tuple[float, ...]:
    """Correct a declared family of p values by Holm's (1979) step-down method.

    A test that could not be made (NaN) still counts as a member of the family, so that a missing
    result never makes the others look more certain; its own corrected value is NaN.
    """
    return tuple(holm_rows(np.asarray(p_values, float)[None])[0].tolist())


def holm_rows(p_values: Floats) -> Floats:
    """Correct many families of equal size, one a row, shape (families, tests); see `holm`."""
    missing = np.isnan(p_values)
    tested = np.where(missing, 1.0, p_values)
    order = np.argsort(tested, axis=1, kind="stable")
    sizes = np.arange(tested.shape[1], 0, -1)
    steps = np.maximum.accumulate(np.take_along_axis(tested, order, axis=1) * sizes, axis=1)
    corrected = np.empty_like(tested)
    np.put_along_axis(corrected, order, np.minimum(1.0, steps), axis=1)
    return np.where(missing, np.nan, corrected)
