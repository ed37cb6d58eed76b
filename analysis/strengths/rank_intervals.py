"""Which ranks conditions can have, given how uncertain their strengths are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Floats = NDArray[np.float64]


def rank_intervals(
    strengths: Floats, covariance: Floats, *, level: float = 0.95, freedom: float = np.inf
) -> tuple[tuple[int, int], ...]:
    """Return for each condition the best and the worst rank that it may have.

    A condition may be best among all that are not surely better. Its differences from all others
    hold together (Bonferroni), so that each interval contains the true rank with at least the
    probability `level` (Mogstad, Romano, Shaikh & Wilhelm 2024).

    Parameters
    ----------
    strengths, covariance : ndarray, shape (K,), (K, K)
        Estimates and their covariance.
    level : float
        Confidence of each interval.
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
    variances = np.diagonal(covariance)
    errors = np.sqrt(np.maximum(variances[:, None] + variances - 2 * covariance, 0))
    margin = stats.t(freedom).ppf(1 - (1 - level) / (2 * (count - 1))) * errors
    difference = strengths[:, None] - strengths
    return tuple(
        (1 + int((gap < -wide).sum()), count - int((gap > wide).sum()))
        for gap, wide in zip(difference, margin, strict=True)
    )
