"""One number per participant: what tests of participants as the only sample stand on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def group_means(values: Floats, groups: NDArray[np.generic]) -> Floats:
    """Return the mean of each group's values, in the order of the groups' names.

    Parameters
    ----------
    values : ndarray, shape (N,)
        One per answer.
    groups : ndarray, shape (N,)
        Whose it is: the participant's, or the segment's.
    """
    codes = np.unique(groups, return_inverse=True)[1]
    counts = np.bincount(codes)
    return np.asarray(np.bincount(codes, weights=values) / counts, np.float64)
