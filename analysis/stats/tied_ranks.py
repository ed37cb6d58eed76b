"""Ranks of numbers that were computed: those equal but for rounding are ties."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Floats = NDArray[np.float64]

ROUNDING: Final = 1e-9
"""Numbers nearer to each other, relative to the largest, are equal."""


def levels(values: Floats) -> NDArray[np.intp]:
    """Return the number of each value among the different ones, from 0, the smallest.

    Parameters
    ----------
    values : ndarray
        Of any shape; finite.
    """
    flat = np.ravel(values)
    if not flat.size:
        return np.zeros(np.shape(values), np.intp)
    order = np.argsort(flat, kind="stable")
    apart = np.diff(flat[order], prepend=flat[order[0]]) > ROUNDING * np.abs(flat).max()
    found = np.empty(flat.size, np.intp)
    found[order] = np.cumsum(apart)
    return found.reshape(np.shape(values))


def tied_ranks(values: Floats) -> Floats:
    """Return the ranks of `values` along the last axis, from 1; ties share the mean of theirs."""
    return np.asarray(stats.rankdata(levels(values), axis=-1), np.float64)
