"""Differences of strengths: their errors, their tests, and the ranks that they allow."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy import sparse, stats

from analysis.stats.clustered_mean import (
    LEVEL,
    ONE_SEGMENT,
    TWO_WAY,
    ClusteredVariance,
    clusterings,
    t_p_value,
    variances,
)
from analysis.stats.f_tests import FTest
from motion.arrays import Floats, Indices

MIXED: Final = f"{TWO_WAY}; by one of them alone if that variance is larger"


@dataclass(frozen=True, kw_only=True, eq=False)
class TwoWayErrors:
    """Errors of strengths and of their differences, clustered by participant and segment.

    Each has its own variance and degrees of freedom, as in `clustered_variance`, so none is
    negative although the two-way matrix may not be positive definite.

    Attributes
    ----------
    errors, freedoms : ndarray, shape (K,)
        Standard error and degrees of freedom of each strength.
    differences, difference_freedoms : ndarray, shape (K, K)
        The same for the difference of each pair of strengths; the diagonals are 0 and NaN.
    by_participant, by_segment, by_cell : ndarray, shape (K, K)
        One-way covariances with the factor G/(G-1) of each clustering.
    method : str
        The kinds of variances used.
    """

    errors: Floats
    freedoms: Floats
    differences: Floats
    difference_freedoms: Floats
    by_participant: Floats
    by_segment: Floats
    by_cell: Floats
    method: str

    @classmethod
    def of(
        cls,
        influences: Floats,
        situation: Indices,
        kind: Indices,
        participants: Indices,
        segments: Indices,
    ) -> TwoWayErrors | None:
        """Return the errors, or None for one participant.

        Parameters
        ----------
        influences : ndarray, shape (kinds, K)
            First-order contribution of an answer of each kind to the strengths' error.
        situation : ndarray of int, shape (kinds,)
            The situation of each kind of answer, from 0; answers in one situation have equal
            weight.
        kind, participants, segments : ndarray of int, shape (N,)
            The kind, the participant and the segment of each answer, from 0.
        """
        if not np.ptp(participants):
            return None
        kinds, one_segment = len(influences), not np.ptp(segments)
        counts = [
            count_kinds(kind, groups, kinds) for groups in clusterings(participants, segments)
        ]
        answers = np.bincount(kind, minlength=kinds)
        situations = sparse.csr_array((answers, (situation, np.arange(kinds))))
        mean = sparse.diags_array(1 / np.maximum(situations.sum(axis=1), 1)) @ situations

        def clustered(values: Floats) -> ClusteredVariance:
            squares = np.asarray(mean @ values**2, np.float64)[situation]
            return variances(values, squares, counts, answers, one_segment=one_segment)

        strengths = clustered(influences)
        rows = [clustered(influences[:, [a]] - influences) for a in range(influences.shape[1])]
        methods = {method for row in rows for method in row.method if method}
        by_participant, by_segment, by_cell = (_matrix(influences, each) for each in counts)
        return cls(
            errors=np.sqrt(strengths.variance),
            freedoms=strengths.df,
            differences=np.sqrt([row.variance for row in rows]),
            difference_freedoms=np.array([row.df for row in rows]),
            by_participant=by_participant,
            by_segment=by_segment,
            by_cell=by_cell,
            method=ONE_SEGMENT if one_segment else TWO_WAY if methods == {TWO_WAY} else MIXED,
        )

    @property
    def freedom(self) -> float:
        """The fewest degrees of freedom of any difference."""
        return float(np.nanmin(self.difference_freedoms, initial=math.inf))


def count_kinds(kind: Indices, groups: Indices, kinds: int) -> sparse.csr_array:
    """Return the number of answers of each kind by group, shape (groups that occur, kinds)."""
    # Counted first, so that a million answers are sorted only once.
    cells, counts = np.unique(groups * kinds + kind, return_counts=True)
    names, group = np.unique(cells // kinds, return_inverse=True)
    votes = counts.astype(np.float64)
    return sparse.coo_array((votes, (group, cells % kinds)), (len(names), kinds)).tocsr()


def _matrix(influences: Floats, counts: sparse.csr_array) -> Floats:
    sums = np.asarray(counts @ influences, np.float64)
    return np.asarray(sums.T @ sums * (len(sums) / (len(sums) - 1)), np.float64)


def standard_errors(covariance: Floats) -> Floats:
    """Return standard errors; variances that rounding made negative count as zero."""
    return np.asarray(np.sqrt(np.maximum(np.diagonal(covariance), 0.0)), np.float64)


def difference_tests(strengths: Floats, errors: TwoWayErrors) -> Floats:
    """Return the two-sided p for each pair of strengths being equal, shape (K, K)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.abs(strengths[:, None] - strengths) / errors.differences
    return t_p_value(t, errors.difference_freedoms)


def omnibus(strengths: Floats, errors: TwoWayErrors) -> FTest:
    """Test whether all strengths are equal, by a Wald test of their two-way covariance.

    Hotelling's T² replaces chi-square (Pustejovsky & Tipton 2018), because few participants or
    segments determine the covariance only imprecisely. In directions in which the two-way matrix is
    smaller than a one-way one, the one-way one replaces it.
    """
    count = len(strengths)
    contrasts = np.eye(count)[1:] - np.eye(count)[0]
    differences = contrasts @ strengths
    by_participant, by_segment, by_cell = (
        contrasts @ matrix @ contrasts.T
        for matrix in (errors.by_participant, errors.by_segment, errors.by_cell)
    )
    freedom, df = errors.freedom, count - 1
    df_rest = freedom - df + 1
    if not df_rest > 0:
        return FTest(
            reason=f"{freedom + 1:.3g} participants or segments, counted by their weight, are too "
            f"few for a joint test of {count} conditions"
        )
    statistic = min(
        _wald(differences, by_participant + _positive_part(by_segment - by_cell, by_cell)),
        _wald(differences, by_segment + _positive_part(by_participant - by_cell, by_cell)),
    )
    f = statistic * df_rest / (freedom * df) / _inflation(errors)
    return FTest(
        statistic=f,
        df=df,
        df_rest=df_rest,
        p_value=float(stats.f.sf(f, df, df_rest)),
        method="Wald test, two-way clustered, Hotelling's T²",
    )


def rank_intervals(strengths: Floats, p_values: Floats) -> tuple[tuple[int, int], ...]:
    """Return the best and the worst rank that each condition may have.

    The best rank is one plus the number of conditions that are significantly better. The tests of
    all pairs are corrected by Bonferroni's method, so that all intervals together contain the true
    ranks with a probability of at least `LEVEL` (Mogstad, Romano, Shaikh & Wilhelm 2024).

    Parameters
    ----------
    strengths : ndarray, shape (K,)
        Estimates.
    p_values : ndarray, shape (K, K)
        p-value of the difference of each pair; see `difference_tests`.

    Returns
    -------
    tuple of (int, int)
        Ranks from 1, the best; (1, K) for all if any strength is unknown.
    """
    count = len(strengths)
    if count < 2 or not np.isfinite(strengths).all():
        return ((1, count),) * count
    significant = p_values < (1 - LEVEL) / (count * (count - 1) / 2)
    gaps = strengths[:, None] - strengths
    better = (significant & (gaps < 0)).sum(axis=1).tolist()
    worse = (significant & (gaps > 0)).sum(axis=1).tolist()
    return tuple((1 + above, count - below) for above, below in zip(better, worse, strict=True))


def _wald(differences: Floats, covariance: Floats) -> float:
    try:
        return float(differences @ np.linalg.solve(covariance, differences))
    except np.linalg.LinAlgError:
        return math.inf


def _positive_part(matrix: Floats, scale: Floats) -> Floats:
    """Return `matrix` without the directions in which it is negative, relative to `scale`."""
    root = np.linalg.cholesky(scale + 1e-12 * np.trace(scale) * np.eye(len(scale)))
    inverse = np.linalg.inv(root)
    values, axes = np.linalg.eigh(inverse @ matrix @ inverse.T)
    return np.asarray(root @ (axes * np.maximum(values, 0.0)) @ axes.T @ root.T, np.float64)


def _inflation(errors: TwoWayErrors) -> float:
    """Return the largest factor by which unequal participants enlarge a difference's variance."""
    two_way = errors.by_participant + errors.by_segment - errors.by_cell
    plain = np.maximum.reduce(
        [
            _variances_of_differences(matrix)
            for matrix in (two_way, errors.by_participant, errors.by_segment)
        ]
    )
    off = ~np.eye(len(plain), dtype=bool)
    return float(max(1.0, np.nanmax(errors.differences[off] ** 2 / plain[off])))


def _variances_of_differences(covariance: Floats) -> Floats:
    variances = np.diagonal(covariance)
    return np.asarray(variances[:, None] + variances - 2 * covariance, np.float64)
