"""Which examples each step learns from, and with what chance: a function of the seed and the step.

Nothing about either needs to be remembered to go on from any step.
"""

from __future__ import annotations

from collections.abc import Sequence

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


def parts_of_step(
    rows: NDArray[np.int64], accumulate: int, processes: int
) -> Sequence[NDArray[np.int64]]:
    """Return the parts in which a step's examples are computed, by all processes together.

    Each process computes equally many parts. One process that makes `n` parts and `n` processes
    that make one each compute the same ones.

    Parameters
    ----------
    rows : ndarray, shape (n,), int64
        Examples of a step, at least as many as processes.
    accumulate : int
        Parts that are wanted, at least 1.
    processes : int
        At least 1.

    Returns
    -------
    sequence of ndarray
        The least multiple of `processes` that is `accumulate` or more, as far as each gets an
        example; their lengths differ by one at most.
    """
    shares = min(-(-accumulate // processes), len(rows) // processes)
    return np.array_split(rows, shares * processes)


def chance_of_part(seed: int, step: int, part: int, update: int = 0) -> int:
    """Return the seed of what is drawn while a part of a step is computed, from 0 to 2**63 - 1.

    Of several updates in a step each, numbered from 0, draws anew.
    """
    entropy = (seed, step, part, *((update,) if update else ()))
    state = np.random.SeedSequence(entropy).generate_state(1, np.uint64)
    return int(state[0] >> np.uint64(1))


def evenly(count: int, most: int) -> NDArray[np.int64]:
    """Return at most so many of `count` examples, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))
