"""Kendall's tau-b and Spearman's rho of many resamples at once."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_ROUNDING: Final = 1e-9
"""Scores nearer to each other, relative to the largest of all, are equal."""


def order_signs(values: Floats) -> Floats:
    """Return which of every two values is the larger.

    Parameters
    ----------
    values : ndarray, shape (B, k)
        Finite.

    Returns
    -------
    ndarray, shape (B, k, k)
        1 where the value of the row is larger than that of the column, -1 where it is smaller,
        0 where they are equal but for rounding.
    """
    apart = values[:, :, None] - values[:, None, :]
    size = np.abs(values).max(axis=1, initial=0)[:, None, None]
    return np.asarray(np.sign(apart) * (np.abs(apart) > _ROUNDING * size), np.float64)


def kendall(first: Floats, second: Floats, weights: Floats) -> Floats:
    """Return Kendall's tau-b (Kendall 1945).

    Parameters
    ----------
    first, second : ndarray, shape (B, k, k)
        The order of k things in each, as `order_signs` gives it.
    weights : ndarray, shape (B, k)
        How often each of them was drawn; one drawn twice is tied with itself.

    Returns
    -------
    ndarray, shape (B,)
        NaN where all that was drawn is tied in either.
    """
    return _scaled(
        *(
            np.einsum("bi,bij,bij,bj->b", weights, one, other, weights, optimize=True)
            for one, other in ((first, second), (first, first), (second, second))
        )
    )


def spearman(first: Floats, second: Floats, weights: Floats) -> Floats:
    """Return Spearman's rho, ties having the mean of their ranks; see `kendall`."""
    ranks = [np.einsum("bij,bj->bi", signs, weights) for signs in (first, second)]
    total = weights.sum(axis=1, keepdims=True)
    centred = [one - (weights * one).sum(axis=1, keepdims=True) / total for one in ranks]
    return _scaled(
        *(
            (weights * centred[one] * centred[other]).sum(axis=1)
            for one, other in ((0, 1), (0, 0), (1, 1))
        )
    )


def _scaled(product: Floats, first: Floats, second: Floats) -> Floats:
    with np.errstate(invalid="ignore", divide="ignore"):
        found = product / np.sqrt(first * second)
    found[(first < _ROUNDING) | (second < _ROUNDING)] = np.nan
    return np.asarray(np.clip(found, -1, 1))
