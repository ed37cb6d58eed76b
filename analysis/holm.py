"""Holm's correction of a declared family of tests."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np


def holm(p_values: Sequence[float]) -> tuple[float, ...]:
    """Correct a declared family of p values by Holm's (1979) step-down method.

    A test that could not be made (NaN) still counts as a member of the family, so that a missing
    result never makes the others look more certain; its own corrected value is NaN.
    """
    family = np.asarray(p_values, float)
    if not family.size:
        return ()
    missing = np.isnan(family)
    tested = np.where(missing, 1.0, family)
    order = np.argsort(tested, kind="stable")
    steps = np.maximum.accumulate(tested[order] * np.arange(len(family), 0, -1))
    corrected = np.empty_like(tested)
    corrected[order] = np.minimum(1.0, steps)
    return tuple(float(p) for p in np.where(missing, math.nan, corrected))
