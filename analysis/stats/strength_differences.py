"""Differences of strengths: their errors, their tests, and the ranks that they allow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse, stats

from analysis.stats.clustered_mean import LEVEL, ONE_SEGMENT, TWO_WAY, larger_variance, one_way
from analysis.stats.f_tests import FTest

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]

ONE_PARTICIPANT: Final = "one participant: no errors, because nothing tells how people differ"

MIXED: Final = f"{TWO_WAY}; by one of them alone where that variance is larger"


@dataclass(frozen=True, kw_only=True, eq=False)
class TwoWayErrors:
    """Errors of strengths and of their differences, clustered by participant and segment.

    Each has the variance and the degrees of freedom of `clustered_variance`. Each is decided by
    itself, so that none has a negative variance although the two-way matrix may not be positive
    definite.

    Attributes
    ----------
    errors, freedoms : ndarray, shape (K,)
        Of each strength.
    differences, difference_freedoms : ndarray, shape (K, K)
        Of the difference of every two strengths; 0 and NaN of one with itself.
    by_participant, by_segment, by_cell : ndarray, shape (K, K)
        One-way covariances with the factor G/(G-1) of each clustering.
    participants, segments : int
        What they rest on.
    method : str
        Which variances were used.
    """

    errors: Floats
    freedoms: Floats
    differences: Floats
    difference_freedoms: Floats
    by_participant: Floats
    by_segment: Floats
    by_cell: Floats
    participants: int
    segments: int
    method: str

    @classmethod
    def of(
        cls,
        influences: Floats,
        situation: Codes,
        kind: Codes,
        participants: Codes,
        segments: Codes,
    ) -> TwoWayErrors | None:
        """Return the errors, or None where there is one participant.

        Parameters
        ----------
        influences : ndarray, shape (kinds, K)
            What an answer of each kind adds to the strengths' error, to first order.
        situation : ndarray of int, shape (kinds,)
            What each kind is an answer to, from 0: answers to one thing weigh alike.
        kind, participants, segments : ndarray of int, shape (N,)
            Each answer's kind, who gave it, and which segment it is about; from 0.
        """
        people, who = np.unique(participants, return_inverse=True)
        things, what = np.unique(segments, return_inverse=True)
        if len(people) < 2:
            return None
        ways = [_counted(kind, codes, len(influences)) for codes in (who, what)]
        ways.append(_counted(kind, who * len(things) + what, len(influences)))
        if len(things) < 2:
            ways = [ways[0]] * 3
        answers = np.bincount(kind, minlength=len(influences))
        asked = sparse.coo_array(
            (answers, (situation, np.arange(len(answers)))),
            (int(situation.max()) + 1, len(answers)),
        ).tocsr()
        mean = sparse.diags_array(1 / np.maximum(asked.sum(axis=1), 1)) @ asked

        def spread(of: Floats) -> _Spread:
            return _spread(of, np.asarray(mean @ of**2, np.float64)[situation], ways, answers)

        alone = spread(influences)
        rows = [spread(influences[:, [a]] - influences) for a in range(influences.shape[1])]
        used = {one for row in rows for one in row.methods if one}
        matrices = [_matrix(influences, way) for way in ways]
        return cls(
            errors=alone.errors,
            freedoms=alone.freedoms,
            differences=np.array([row.errors for row in rows]),
            difference_freedoms=np.array([row.freedoms for row in rows]),
            by_participant=matrices[0],
            by_segment=matrices[1],
            by_cell=matrices[2],
            participants=len(people),
            segments=len(things),
            method=ONE_SEGMENT if len(things) < 2 else TWO_WAY if used == {TWO_WAY} else MIXED,
        )

    @property
    def freedom(self) -> float:
        """The fewest degrees of freedom of any difference."""
        return float(np.nanmin(self.difference_freedoms, initial=math.inf))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Spread:
    errors: Floats
    freedoms: Floats
    methods: tuple[str, ...]


def _spread(
    influences: Floats, squares: Floats, ways: Sequence[sparse.csr_array], answers: Codes
) -> _Spread:
    """Return errors and degrees of freedom of several estimates, shape (kinds, estimates)."""
    independent = answers @ squares
    there = independent > 0
    total = np.where(there, independent, math.nan)
    found = [one_way(way @ influences, (way @ squares) / total) for way in ways]
    chosen = [
        larger_variance(*parts, answers=int(answers.sum())) if yes else (0.0, "")
        for yes, *parts in zip(
            there.tolist(), *(one[0].tolist() for one in found), independent.tolist(), strict=True
        )
    ]
    return _Spread(
        errors=np.sqrt([variance for variance, _ in chosen]),
        freedoms=np.minimum(found[0][1], found[1][1]),
        methods=tuple(method for _, method in chosen),
    )


def _counted(kind: Codes, groups: Codes, kinds: int) -> sparse.csr_array:
    """Return how many answers of each kind each group gave."""
    named, group = np.unique(groups, return_inverse=True)
    table = sparse.coo_array((np.ones(len(kind)), (group, kind)), (len(named), kinds))
    return table.tocsr()


def _matrix(influences: Floats, way: sparse.csr_array) -> Floats:
    sums = np.asarray(way @ influences, np.float64)
    return np.asarray(sums.T @ sums * (len(sums) / (len(sums) - 1)), np.float64)


def standard_errors(covariance: Floats) -> Floats:
    """Return standard errors from a covariance whose variances may be negative by rounding."""
    return np.asarray(np.sqrt(np.maximum(np.diagonal(covariance), 0.0)), np.float64)


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


def rank_intervals(strengths: Floats, p_values: Floats) -> tuple[tuple[int, int], ...]:
    """Return for each condition the best and the worst rank that it may have.

    A condition may be best among all that are not surely better. The differences of every two
    conditions hold together (Bonferroni), so that all intervals contain the true ranks together
    with at least the probability `LEVEL` (Mogstad, Romano, Shaikh & Wilhelm 2024).

    Parameters
    ----------
    strengths : ndarray, shape (K,)
        Estimates.
    p_values : ndarray, shape (K, K)
        Of the difference of every two of them; see `difference_tests`.

    Returns
    -------
    tuple of (int, int)
        Ranks from 1, the best; (1, K) where a strength is unknown.
    """
    count = len(strengths)
    if count < 2 or not np.isfinite(strengths).all():
        return ((1, count),) * count
    apart = p_values < (1 - LEVEL) / (count * (count - 1) / 2)
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
