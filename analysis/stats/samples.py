"""Samples of answers: grouped, ranked, and resampled by the two-way bootstrap.

The bootstrap draws participants and items. An answer's weight is the product of the draws of its
participant and of its item (the pigeonhole bootstrap of Owen 2007). It needs only the sums of each
participant-item cell, so drawing costs two matrix products.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from motion.arrays import Floats, Indices

ROUNDING: Final = 1e-9
"""Numbers that differ by less, relative to the largest, are equal."""


def group_means(values: Floats, groups: NDArray[np.generic]) -> Floats:
    """Return the mean of each group's values, in the order of the groups' names.

    Parameters
    ----------
    values : ndarray, shape (N,)
        One per answer.
    groups : ndarray, shape (N,)
        The participant, or the segment, of each value.
    """
    codes = np.unique(groups, return_inverse=True)[1]
    counts = np.bincount(codes)
    return np.asarray(np.bincount(codes, weights=values) / counts, np.float64)


def levels(values: Floats) -> Indices:
    """Return the index of each value among the sorted distinct ones, from 0.

    Parameters
    ----------
    values : ndarray
        Values of any shape; finite.
    """
    flat = np.ravel(values)
    if not flat.size:
        return np.zeros(np.shape(values), np.intp)
    order = np.argsort(flat, kind="stable")
    larger = np.diff(flat[order], prepend=flat[order[0]]) > ROUNDING * np.abs(flat).max()
    numbers = np.empty(flat.size, np.intp)
    numbers[order] = np.cumsum(larger)
    return numbers.reshape(np.shape(values))


def tied_ranks(values: Floats) -> Floats:
    """Return the ranks of `values` along the last axis, from 1; ties share their mean rank."""
    return np.asarray(stats.rankdata(levels(values), axis=-1), np.float64)


def percentile_interval(draws: Floats) -> tuple[float, float]:
    """Return the ends between which the middle 95% of the draws lie."""
    low, high = np.nanquantile(draws, [0.025, 0.975])
    return float(low), float(high)


def bootstrap_counts(chance: np.random.Generator, size: int, count: int) -> Floats:
    """Return how often each of `count` items was drawn in each of `size` resamples.

    Returns
    -------
    ndarray, shape (size, count)
        Every row sums to `count`.
    """
    drawn = chance.integers(count, size=(size, count))
    drawn += count * np.arange(size)[:, None]
    counts = np.bincount(drawn.ravel(), minlength=size * count)
    return counts.reshape(size, count).astype(np.float64)
