"""Adaptive pairs: ask about the pair of conditions whose answer is the most informative.

The strengths of the conditions have a Bradley–Terry likelihood and a wide normal prior; the
posterior is approximated by a normal distribution around its mode (Laplace). The information in an
answer is the expected drop in entropy, ½ log(1 + p (1 − p) v), with p the probability that the
first is preferred and v the posterior variance of the difference (D-optimality; Chaloner &
Verdinelli 1995, Bayesian experimental design: a review).
"""

from collections.abc import Sequence
from itertools import combinations
from typing import Final

import numpy as np

from motion.arrays import Floats
from studyapp.study.design.trial import Tally

Pair = tuple[str, str]

PRIOR_SD: Final = 2.0
"""Prior standard deviation of a condition's strength, in logits."""

MAX_NEWTON_STEPS: Final = 50
TOLERANCE: Final = 1e-9


def most_informative_pairs(
    conditions: Sequence[str], votes: Tally, count: int, chance: np.random.Generator
) -> list[Pair]:
    """Return the next `count` pairs for one participant, the most informative first.

    Each choice narrows the posterior as its answer is expected to, so that one pair is not asked
    again and again. Ties are broken at random.

    Parameters
    ----------
    conditions : sequence of str
        At least two.
    votes : Tally
        The answers so far; other conditions are ignored.
    """
    strengths, covariance = posterior(conditions, votes)
    pairs = list(combinations(conditions, 2))
    contrasts = np.array([[(c == a) - (c == b) for c in conditions] for a, b in pairs], np.float64)
    probabilities = 1 / (1 + np.exp(-contrasts @ strengths))
    information = probabilities * (1 - probabilities)
    chosen: list[Pair] = []
    for _ in range(count):
        variances = ((contrasts @ covariance) * contrasts).sum(axis=1)
        gains = 0.5 * np.log1p(information * variances)
        best = int(chance.choice(np.flatnonzero(gains >= gains.max() - TOLERANCE)))
        chosen.append(pairs[best])
        # The covariance after one more answer about this pair (Sherman-Morrison).
        row = covariance @ contrasts[best]
        gain = information[best] / (1 + information[best] * variances[best])
        covariance = covariance - np.outer(row, row) * gain
    return chosen


def posterior(conditions: Sequence[str], votes: Tally) -> tuple[Floats, Floats]:
    """Return the mode and covariance of the strengths of `conditions`, in logits.

    Returns
    -------
    strengths : ndarray, shape (C,)
    covariance : ndarray, shape (C, C)
    """
    size = len(conditions)
    wins = np.array([[votes.get((a, b), 0.0) for b in conditions] for a in conditions])
    np.fill_diagonal(wins, 0.0)
    comparisons = wins + wins.T
    prior = np.eye(size) / PRIOR_SD**2
    strengths = np.zeros(size)
    for _ in range(MAX_NEWTON_STEPS):
        probabilities = 1 / (1 + np.exp(strengths[None, :] - strengths[:, None]))
        gradient = (wins - comparisons * probabilities).sum(axis=1) - prior @ strengths
        weights = comparisons * probabilities * (1 - probabilities)
        precision = np.diag(weights.sum(axis=1)) - weights + prior
        step = np.linalg.solve(precision, gradient)
        strengths = strengths + step
        if np.abs(step).max() < TOLERANCE:
            break
    return strengths, np.linalg.inv(precision)
