"""Errors of strengths when answers share participants and segments."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from analysis.clustered_variance import TWO_WAY, larger_variance

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]

ONE_PARTICIPANT: Final = "one participant: no errors, because nothing tells how people differ"

MIXED: Final = f"{TWO_WAY}; by one of them alone where that variance is larger"


@dataclass(frozen=True, kw_only=True, eq=False)
class TwoWayErrors:
    """Covariances of strengths, clustered by participant, by segment and by both together.

    A difference of strengths has the two-way cluster-robust variance (Cameron, Gelbach & Miller
    2011, CR1), or a one-way one where that is larger: the rule of `clustered_variance`. Each
    difference is decided by itself, so that none has a negative variance although the two-way
    matrix may not be positive definite.

    Attributes
    ----------
    by_participant, by_segment, by_cell : ndarray, shape (K, K)
        One-way covariances with the factor G/(G-1) of each clustering.
    independent : ndarray, shape (K, K)
        Sum of the answers' squared influences.
    participants, segments, answers : int
        What they rest on, at least two of each.
    """

    by_participant: Floats
    by_segment: Floats
    by_cell: Floats
    independent: Floats
    participants: int
    segments: int
    answers: int

    @classmethod
    def of(
        cls, influences: Floats, kind: Codes, participants: Codes, segments: Codes
    ) -> TwoWayErrors | None:
        """Return the errors, or None where there is one participant or one segment.

        Parameters
        ----------
        influences : ndarray, shape (kinds, K)
            What an answer of each kind adds to the strengths' error, to first order.
        kind, participants, segments : ndarray of int, shape (N,)
            Each answer's kind, who gave it, and which segment it is about; from 0.
        """
        people, who = np.unique(participants, return_inverse=True)
        things, what = np.unique(segments, return_inverse=True)
        if len(people) < 2 or len(things) < 2:
            return None
        cells, cell = np.unique(who * len(things) + what, return_inverse=True)
        counts = np.bincount(kind, minlength=len(influences))[:, None]
        return cls(
            by_participant=_one_way(influences, kind, who, len(people)),
            by_segment=_one_way(influences, kind, what, len(things)),
            by_cell=_one_way(influences, kind, cell, len(cells)),
            independent=influences.T @ (counts * influences),
            participants=len(people),
            segments=len(things),
            answers=len(kind),
        )

    @property
    def freedom(self) -> int:
        """Degrees of freedom of the errors: of t with so few independent groups."""
        return min(self.participants, self.segments) - 1

    @cached_property
    def errors(self) -> Floats:
        """Standard error of each strength, shape (K,)."""
        return np.array([self._error(weights)[0] for weights in np.eye(len(self.by_cell))])

    @cached_property
    def differences(self) -> Floats:
        """Standard error of the difference of every two strengths, shape (K, K); 0 of none."""
        return np.array([[error for error, _ in row] for row in self._differences])

    @cached_property
    def method(self) -> str:
        """Which variances were used."""
        used = {method for row in self._differences for _, method in row if method}
        return TWO_WAY if used == {TWO_WAY} else MIXED

    @cached_property
    def _differences(self) -> list[list[tuple[float, str]]]:
        count = len(self.by_cell)
        unit = np.eye(count)
        return [
            [self._error(unit[a] - unit[b]) if a != b else (0.0, "") for b in range(count)]
            for a in range(count)
        ]

    def _error(self, weights: Floats) -> tuple[float, str]:
        one_way = [
            float(weights @ covariance @ weights)
            for covariance in (self.by_participant, self.by_segment, self.by_cell, self.independent)
        ]
        variance, method = larger_variance(*one_way, answers=self.answers)
        return math.sqrt(variance), method


def deviations(covariance: Floats) -> Floats:
    """Return standard errors from a covariance whose variances may be negative by rounding."""
    return np.asarray(np.sqrt(np.maximum(np.diagonal(covariance), 0.0)), np.float64)


def _one_way(influences: Floats, kind: Codes, groups: Codes, count: int) -> Floats:
    table = sparse.coo_array((np.ones(len(kind)), (groups, kind)), (count, len(influences)))
    sums = np.asarray(table.tocsr() @ influences, np.float64)
    return np.asarray(sums.T @ sums * (count / (count - 1)), np.float64)
