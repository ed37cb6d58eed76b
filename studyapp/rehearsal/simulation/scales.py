"""From what a rater feels to what it answers on each kind of scale."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import logit

if TYPE_CHECKING:
    from studyapp.rehearsal.simulation.population import Population


def preference_thresholds(population: Population, levels: int) -> tuple[float, ...]:
    """Return the borders between `levels` (2, 3 or 5) preferences from A to B, in logits."""
    weak, strong = population.weak, population.strong
    return {2: (0.0,), 3: (-weak, weak), 5: (-strong, -weak, weak, strong)}[levels]


def rating_thresholds(population: Population, levels: int) -> tuple[float, ...]:
    """Return the borders between `levels` equally wide steps of a rating scale, in logits.

    A latent value of 0 lies in the middle of the scale. A slider is the same scale in finer
    steps, so that its five bands hold what five labels would be given for.
    """
    shares = np.arange(1, levels) / levels
    return tuple((population.rating_spread * logit(shares)).tolist())


def step(values: Sequence[int], thresholds: Sequence[float], latent: float) -> int:
    """Return the one of `values` that `latent` falls on; there is one threshold fewer."""
    return values[int(np.searchsorted(thresholds, latent))]


def ranks(utilities: Sequence[float], *, tie_within: float | None = None) -> tuple[int, ...]:
    """Return the rank of each of `utilities`, the highest first, counted from 1 without gaps.

    Parameters
    ----------
    utilities : sequence of float
        With their noise, in logits.
    tie_within : float, optional
        What is at most so far below the best of a rank shares it; by default nothing does.
    """
    order = sorted(range(len(utilities)), key=lambda index: -utilities[index])
    found = [0] * len(utilities)
    rank, best = 0, 0.0
    for index in order:
        if not rank or tie_within is None or best - utilities[index] > tie_within:
            rank, best = rank + 1, utilities[index]
        found[index] = rank
    return tuple(found)
