"""How much sooner adaptive pairs tell conditions apart than others: simulated tournaments.

Conditions have known strengths, and participants answer as a Bradley–Terry model says. All ways of
choosing pairs are given the same conditions and as many answers, and are judged by the same
posterior.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.stats import kendalltau

from studyapp.study.design.adaptive import Pair, most_informative_pairs, posterior
from studyapp.study.design.allocation import shuffled

Choice = Literal["adaptive", "even", "random"]
"""How pairs are chosen: by what an answer is worth; all in turn along a ring in random order, as
``comparisons = "all_pairs"`` does; or each by itself, any as likely as another."""

CHOICES: Final[tuple[Choice, ...]] = ("adaptive", "even", "random")

TRIALS: Final = 12
"""Pairs that each participant answers."""


@dataclass(frozen=True, kw_only=True)
class Knowledge:
    """What is known after a number of participants.

    Attributes
    ----------
    tau : float
        Kendall's rank correlation of the estimated with the true strengths.
    error : float
        Root mean square error of the strengths around their mean, in logits.
    """

    tau: float
    error: float


def tournament(
    strengths: NDArray[np.float64], *, choice: Choice, participants: int, seed: int
) -> Iterator[Knowledge]:
    """Yield what is known after each of `participants`, who answer `TRIALS` pairs each.

    Parameters
    ----------
    strengths : ndarray, shape (C,)
        What is to be found out, in logits.
    choice : {'adaptive', 'even', 'random'}
        How pairs are chosen.
    participants : int
        How many come.
    seed : int
        Of the pairs and of the answers.
    """
    chance = np.random.default_rng(seed)
    names = [str(index) for index in range(len(strengths))]
    ring = shuffled(list(combinations(names, 2)), chance)
    votes: dict[Pair, float] = {}
    for number in range(participants):
        for a, b in _pairs(names, ring, number, votes, chance, choice):
            gap = strengths[int(a)] - strengths[int(b)]
            winner = (a, b) if chance.random() < 1 / (1 + np.exp(-gap)) else (b, a)
            votes[winner] = votes.get(winner, 0.0) + 1
        estimate, _ = posterior(names, votes)
        difference = (estimate - estimate.mean()) - (strengths - strengths.mean())
        yield Knowledge(
            tau=float(kendalltau(estimate, strengths).statistic),
            error=float(np.sqrt(np.mean(difference**2))),
        )


def _pairs(
    names: Sequence[str],
    ring: Sequence[Pair],
    number: int,
    votes: dict[Pair, float],
    chance: np.random.Generator,
    choice: Choice,
) -> list[Pair]:
    """Return the pairs that participant `number` answers."""
    if choice == "adaptive":
        return most_informative_pairs(names, votes, TRIALS, chance)
    if choice == "even":
        return [ring[(number * TRIALS + step) % len(ring)] for step in range(TRIALS)]
    return [ring[index] for index in chance.integers(len(ring), size=TRIALS)]
