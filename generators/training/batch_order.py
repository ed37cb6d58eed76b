"""Which examples each step learns from: a function of the seed and the step alone.

Nothing about the order needs to be remembered to go on from any step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def batches_per_epoch(examples: int, batch_size: int) -> int:
    """Return how many whole batches `examples` make; one where they fill none."""
    return max(1, examples // batch_size)


def rows_of_step(step: int, examples: int, batch_size: int, seed: int) -> NDArray[np.int64]:
    """Return the examples of a step.

    Parameters
    ----------
    step : int
        From 0.
    examples, batch_size : int
        At least 1.
    seed : int
        Not negative.

    Returns
    -------
    ndarray, shape (min(batch_size, examples),), int64
        Each epoch goes through all examples in an order of its own; what fills no batch at its
        end is left out of it.
    """
    epoch, place = divmod(step, batches_per_epoch(examples, batch_size))
    order = np.random.default_rng((seed, epoch)).permutation(examples)
    return order[place * batch_size : (place + 1) * batch_size]
