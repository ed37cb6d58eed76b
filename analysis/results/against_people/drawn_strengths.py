"""Bradley-Terry strengths of many resampled studies at once."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

PSEUDO_VOTES: Final = 0.01
"""Votes for each side that every compared pair is given, so that strengths stay finite where one
side won always."""

_STEPS: Final = 100
_LONGEST_STEP: Final = 1.5
_CLOSE: Final = 1e-9


def drawn_strengths(wins: Floats) -> Floats:
    """Fit a Bradley-Terry model, ties counting one half, to each of many tables of wins.

    Parameters
    ----------
    wins : ndarray, shape (B, k, k)
        How often the condition of the row was preferred to that of the column, with half of the
        ties.

    Returns
    -------
    ndarray, shape (B, k)
        Log strengths that add up to zero; NaN where the compared pairs do not connect all
        conditions, so that some cannot be set against others.
    """
    count = wins.shape[-1]
    compared = (wins + wins.swapaxes(1, 2)) > 0
    usable = _connected(compared)
    won = wins[usable] + PSEUDO_VOTES * compared[usable]
    votes = won + won.swapaxes(1, 2)
    strengths = np.zeros((len(won), count))
    # Every strength may move by one amount: this holds them in place.
    fixed = np.full((count, count), 1 / count)
    for _ in range(_STEPS):
        chance = 1 / (1 + np.exp(strengths[:, None, :] - strengths[:, :, None]))
        gradient = (won - votes * chance).sum(axis=2)
        weights = votes * chance * (1 - chance)
        information = -weights
        information[:, np.arange(count), np.arange(count)] = weights.sum(axis=2)
        step = np.linalg.solve(information + fixed, gradient[..., None])[..., 0]
        longest = np.abs(step).max(axis=1, keepdims=True, initial=0)
        step *= np.minimum(1, _LONGEST_STEP / np.maximum(longest, _CLOSE))
        strengths += step
        if np.abs(step).max(initial=0) < _CLOSE:
            break
    found = np.full(wins.shape[:2], np.nan)
    found[usable] = strengths - strengths.mean(axis=1, keepdims=True)
    return found


def _connected(compared: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which of the graphs, shape (B, k, k), are in one piece."""
    count = compared.shape[-1]
    reached = compared | np.eye(count, dtype=bool)
    for _ in range(max(1, count - 1).bit_length()):
        reached = np.matmul(reached.astype(np.float32), reached.astype(np.float32)) > 0
    return np.asarray(reached.all(axis=(1, 2)))
