"""Which pair of conditions to ask about next: the one whose answer is worth most.

The strengths of the conditions have a Bradley–Terry likelihood and a wide normal prior; their
posterior is taken as normal around its mode (Laplace). What an answer to a pair is worth is the
entropy it is expected to take from that posterior, ½ log(1 + p (1 − p) v), with p the probability
that the first is preferred and v the posterior variance of the difference (Chaloner & Verdinelli
1995, Bayesian experimental design: a review; D-optimality).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from studyapp.study.design.trial import Tally

Pair = tuple[str, str]

PRIOR_SD: Final = 2.0
"""Standard deviation of a condition's strength before anybody has answered, in logits."""

MAX_NEWTON_STEPS: Final = 50
TOLERANCE: Final = 1e-9


def most_informative_pairs(
    conditions: Sequence[str], votes: Tally, count: int, chance: np.random.Generator
) -> list[Pair]:
    """Return the next `count` pairs to ask one participant about, the worthiest first.

    After each choice the posterior is narrowed as its answer is expected to, so that one pair is
    not asked again and again. Among equally worthy pairs `chance` decides.

    Parameters
    ----------
    conditions : sequence of str
        At least two.
    votes : Tally
        What was answered so far; pairs of other conditions are left aside.
    """
    strengths, covariance = posterior(conditions, votes)
    indices = list(combinations(range(len(conditions)), 2))
    chosen: list[Pair] = []
    for _ in range(count):
        worth = np.array([_expected_information(strengths, covariance, i, j) for i, j in indices])
        best = np.flatnonzero(worth >= worth.max() - TOLERANCE)
        i, j = indices[int(chance.choice(best))]
        chosen.append((conditions[i], conditions[j]))
        covariance = _update_covariance(strengths, covariance, i, j)
    return chosen


def posterior(
    conditions: Sequence[str], votes: Tally
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return mode and covariance of the strengths of `conditions`, in logits.

    Returns
    -------
    strengths : ndarray, shape (C,)
    covariance : ndarray, shape (C, C)
    """
    size = len(conditions)
    wins = np.array([[votes.get((a, b), 0.0) for b in conditions] for a in conditions])
    np.fill_diagonal(wins, 0.0)
    asked = wins + wins.T
    prior = np.eye(size) / PRIOR_SD**2
    strengths = np.zeros(size)
    for _ in range(MAX_NEWTON_STEPS):
        chances = _preference_probabilities(strengths)
        slope = (wins - asked * chances).sum(axis=1) - prior @ strengths
        weights = asked * chances * (1 - chances)
        precision = np.diag(weights.sum(axis=1)) - weights + prior
        step = np.linalg.solve(precision, slope)
        strengths = strengths + step
        if np.abs(step).max() < TOLERANCE:
            break
    return strengths, np.linalg.inv(precision)


def _preference_probabilities(strengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how probable it is that the row's condition is preferred to the column's."""
    return 1 / (1 + np.exp(strengths[None, :] - strengths[:, None]))


def _information(strengths: NDArray[np.float64], i: int, j: int) -> float:
    chance = 1 / (1 + np.exp(strengths[j] - strengths[i]))
    return float(chance * (1 - chance))


def _expected_information(
    strengths: NDArray[np.float64], covariance: NDArray[np.float64], i: int, j: int
) -> float:
    spread = covariance[i, i] + covariance[j, j] - 2 * covariance[i, j]
    return float(0.5 * np.log1p(_information(strengths, i, j) * spread))


def _update_covariance(
    strengths: NDArray[np.float64], covariance: NDArray[np.float64], i: int, j: int
) -> NDArray[np.float64]:
    """Return the covariance after one more answer about a pair (Sherman–Morrison)."""
    information = _information(strengths, i, j)
    row = covariance[i] - covariance[j]
    spread = row[i] - row[j]
    narrowed: NDArray[np.float64] = covariance - np.outer(row, row) * (
        information / (1 + information * spread)
    )
    return narrowed
