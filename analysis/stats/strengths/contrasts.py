"""Differences of strengths: their tests, one test of all together, and the ranks they allow."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.min_f import FTest
from analysis.stats.strengths.two_way import TwoWayErrors

Floats = NDArray[np.float64]


def difference_tests(strengths: Floats, errors: TwoWayErrors) -> Floats:
    """Return the two-sided p of every two strengths being equal, shape (K, K)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.abs(strengths[:, None] - strengths) / errors.differences
    return np.asarray(2 * stats.t(errors.difference_freedoms).sf(distance), np.float64)


def omnibus(strengths: Floats, errors: TwoWayErrors) -> FTest:
    """Test whether all strengths are equal, by a Wald test of their two-way covariance.

    Hotelling's T² takes the place of chi-square (Pustejovsky & Tipton 2018): with few participants
    or segments the covariance is not well known. Where the two-way matrix is smaller than a
    one-way one in some direction, the one-way one takes its place there.
    """
    count = len(strengths)
    turn = np.eye(count)[1:] - np.eye(count)[0]
    differences = turn @ strengths
    by_participant, by_segment, by_cell = (
        turn @ matrix @ turn.T
        for matrix in (errors.by_participant, errors.by_segment, errors.by_cell)
    )
    freedom, wanted = errors.freedom, count - 1
    rest = freedom - wanted + 1
    if not rest > 0:
        return FTest(
            reason=f"{freedom + 1:.3g} participants or segments, counted by their weight, are too "
            f"few for one test of {count} conditions"
        )
    statistic = min(
        _wald(differences, by_participant + _positive_part(by_segment - by_cell, by_cell)),
        _wald(differences, by_segment + _positive_part(by_participant - by_cell, by_cell)),
    )
    f = statistic * rest / (freedom * wanted) / _inflation(errors)
    return FTest(
        statistic=f,
        df=wanted,
        df_rest=rest,
        p_value=float(stats.f.sf(f, wanted, rest)),
        method="Wald test, two-way clustered, Hotelling's T²",
    )


def rank_intervals(
    strengths: Floats, p_values: Floats, *, level: float = 0.95
) -> tuple[tuple[int, int], ...]:
    """Return for each condition the best and the worst rank that it may have.

    A condition may be best among all that are not surely better. The differences of every two
    conditions hold together (Bonferroni), so that all intervals contain the true ranks together
    with at least the probability `level` (Mogstad, Romano, Shaikh & Wilhelm 2024).

    Parameters
    ----------
    strengths : ndarray, shape (K,)
        Estimates.
    p_values : ndarray, shape (K, K)
        Of the difference of every two of them; see `difference_tests`.
    level : float
        Confidence of all intervals together.

    Returns
    -------
    tuple of (int, int)
        Ranks from 1, the best; (1, K) where a strength is unknown.
    """
    count = len(strengths)
    if count < 2 or not np.isfinite(strengths).all():
        return ((1, count),) * count
    apart = p_values < (1 - level) / (count * (count - 1) / 2)
    gaps = strengths[:, None] - strengths
    return tuple(
        (
            1 + int((apart[one] & (gaps[one] < 0)).sum()),
            count - int((apart[one] & (gaps[one] > 0)).sum()),
        )
        for one in range(count)
    )


def _wald(differences: Floats, covariance: Floats) -> float:
    try:
        return float(differences @ np.linalg.solve(covariance, differences))
    except np.linalg.LinAlgError:
        return math.inf


def _positive_part(matrix: Floats, scale: Floats) -> Floats:
    """Return `matrix` without the directions in which it is negative, measured by `scale`."""
    root = np.linalg.cholesky(scale + 1e-12 * np.trace(scale) * np.eye(len(scale)))
    inverse = np.linalg.inv(root)
    values, axes = np.linalg.eigh(inverse @ matrix @ inverse.T)
    return np.asarray(root @ (axes * np.maximum(values, 0.0)) @ axes.T @ root.T, np.float64)


def _inflation(errors: TwoWayErrors) -> float:
    """Return by how much very unequal participants enlarge the variance of a difference at most."""
    plain = np.maximum.reduce(
        [
            _variances(errors.by_participant + errors.by_segment - errors.by_cell),
            _variances(errors.by_participant),
            _variances(errors.by_segment),
        ]
    )
    off = ~np.eye(len(plain), dtype=bool)
    return float(max(1.0, np.nanmax(errors.differences[off] ** 2 / plain[off])))


def _variances(covariance: Floats) -> Floats:
    own = np.diagonal(covariance)
    return np.asarray(own[:, None] + own - 2 * covariance, np.float64)
