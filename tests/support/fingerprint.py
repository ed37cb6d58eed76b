"""A few numbers that change with any of the values they are of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def fingerprint(*arrays: NDArray[np.generic]) -> list[float]:
    """Return the mean of each array weighted by fixed chance, which rounding hardly moves."""
    found = []
    for number, values in enumerate(arrays):
        given = np.asarray(values, float).ravel()
        weights = np.random.default_rng((number, given.size)).standard_normal(given.size)
        found.append(float(weights @ given / np.sqrt(max(given.size, 1))))
    return found
