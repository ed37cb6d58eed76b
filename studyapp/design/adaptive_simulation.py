"""How much sooner adaptive pairs tell conditions apart than random ones.

``python -m studyapp.design.adaptive_simulation`` simulates tournaments of conditions with known
strengths and prints, after so many answers, how well their order is known (Kendall's τ with the
true one) and how far off the strengths are (root mean square, logits), either way.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.stats import kendalltau

from studyapp.design.adaptive import Pair, posterior, worthiest_pairs

CONDITIONS: Final = 10
STRENGTH_SD: Final = 1.0
TRIALS: Final = 12
PARTICIPANTS: Final = 60
REPETITIONS: Final = 40
SHOWN_AT: Final = (5, 10, 20, 40, 60)


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
    strengths: NDArray[np.float64], *, adaptive: bool, participants: int, seed: int
) -> Iterator[Knowledge]:
    """Yield what is known after each of `participants`, who answer `TRIALS` pairs each."""
    chance = np.random.default_rng(seed)
    names = [str(index) for index in range(len(strengths))]
    votes: dict[Pair, float] = {}
    for _ in range(participants):
        for a, b in _pairs(names, votes, chance, adaptive=adaptive):
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
    names: Sequence[str], votes: dict[Pair, float], chance: np.random.Generator, *, adaptive: bool
) -> list[Pair]:
    if adaptive:
        return worthiest_pairs(names, votes, TRIALS, chance)
    pairs = list(combinations(names, 2))
    return [pairs[index] for index in chance.integers(len(pairs), size=TRIALS)]


def main() -> None:
    """Print the curves."""
    curves: dict[bool, list[list[Knowledge]]] = {True: [], False: []}
    for seed in range(REPETITIONS):
        strengths = np.random.default_rng([seed, 1]).normal(0, STRENGTH_SD, CONDITIONS)
        for adaptive, runs in curves.items():
            runs.append(
                list(tournament(strengths, adaptive=adaptive, participants=PARTICIPANTS, seed=seed))
            )
    print("answers  τ adaptive  τ random  error adaptive  error random")
    for number in SHOWN_AT:
        means = [
            np.mean([getattr(run[number - 1], what) for run in curves[adaptive]])
            for what in ("tau", "error")
            for adaptive in (True, False)
        ]
        print(
            f"{number * TRIALS:7}  {means[0]:10.3f}  {means[1]:8.3f}  {means[2]:14.3f}  "
            f"{means[3]:12.3f}"
        )


if __name__ == "__main__":
    main()
