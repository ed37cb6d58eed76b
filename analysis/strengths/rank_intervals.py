"""Which ranks conditions can have, given how uncertain their strengths are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Floats = NDArray[np.float64]


def rank_intervals(
    strengths: Floats, errors: Floats, *, level: float = 0.95, freedom: float = np.inf
) -> tuple[tuple[int, int], ...]:
    """Return for each condition the best and the worst rank that it may have.

    A condition may be best among all that are not surely better. The differences of every two
    conditions hold together (Bonferroni), so that all intervals contain the true ranks together
    with at least the probability `level` (Mogstad, Romano, Shaikh & Wilhelm 2024).

    Parameters
    ----------
    strengths : ndarray, shape (K,)
        Estimates.
    errors : ndarray, shape (K, K)
        Standard error of the difference of every two of them; see `errors_of_differences`.
    level : float
        Confidence of all intervals together.
    freedom : float
        Degrees of freedom of the errors.

    Returns
    -------
    tuple of (int, int)
        Ranks from 1, the best; (1, K) where a strength is unknown.
    """
    count = len(strengths)
    if count < 2 or not np.isfinite(strengths).all():
        return ((1, count),) * count
    pairs = count * (count - 1) / 2
    margin = stats.t(freedom).ppf(1 - (1 - level) / (2 * pairs)) * errors
    difference = strengths[:, None] - strengths
    return tuple(
        (1 + int((gap < -wide).sum()), count - int((gap > wide).sum()))
        for gap, wide in zip(difference, margin, strict=True)
    )


def errors_of_differences(covariance: Floats) -> Floats:
    """Return the standard error of the difference of every two strengths from their covariance."""
    variances = np.diagonal(covariance)
    squares = variances[:, None] + variances - 2 * covariance
    return np.asarray(np.sqrt(np.maximum(squares, 0)), np.float64)
