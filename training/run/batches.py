"""The examples of each step of a training.

Examples and randomness are a function of the seed and the step, so nothing needs to be saved to
resume from any step. One or several processes may compute a step in parts.
"""

from collections.abc import Sequence

import numpy as np

from motion.arrays import Ints


def batches_per_epoch(examples: int, batch_size: int) -> int:
    """Return the number of whole batches of `examples`, at least one."""
    return max(1, examples // batch_size)


def step_rows(step: int, examples: int, batch_size: int, seed: int) -> Ints:
    """Return the examples of a step.

    Parameters
    ----------
    step : int
        Number of the step, from 0.
    examples, batch_size : int
        Numbers of examples in all and per step, at least 1.
    seed : int
        Random seed, at least 0.

    Returns
    -------
    ndarray, shape (min(batch_size, examples),), int64
        Indices of the examples. Each epoch goes through all examples in a new order; an incomplete
        last batch is dropped.
    """
    epoch, place = divmod(step, batches_per_epoch(examples, batch_size))
    order = np.random.default_rng((seed, epoch)).permutation(examples)
    return order[place * batch_size : (place + 1) * batch_size]


def step_parts(rows: Ints, accumulate: int, processes: int) -> Sequence[Ints]:
    """Divide a step's examples into the parts that the processes compute.

    Each process computes equally many parts. One process with `n` parts and `n` processes with one
    part each compute the same parts.

    Parameters
    ----------
    rows : ndarray, shape (n,), int64
        Examples of a step, at least as many as processes.
    accumulate : int
        Number of parts, at least 1.
    processes : int
        Number of processes, at least 1.

    Returns
    -------
    sequence of ndarray
        Their number is the smallest multiple of `processes` that is at least `accumulate`, or less
        if there are too few examples. Their lengths differ by at most one.
    """
    shares = min(-(-accumulate // processes), len(rows) // processes)
    return np.array_split(rows, shares * processes)


def part_seed(seed: int, step: int, part: int, update: int = 0) -> int:
    """Return the random seed of a part of a step, from 0 to 2**63 - 1.

    Each of the updates in a step, numbered from 0, has its own seeds.
    """
    entropy = (seed, step, part, *((update,) if update else ()))
    state = np.random.SeedSequence(entropy).generate_state(1, np.uint64)
    return int(state[0] >> np.uint64(1))


def evenly_spaced(count: int, limit: int) -> Ints:
    """Return at most `limit` of `count` indices, including the first and the last."""
    return np.unique(np.linspace(0, count - 1, min(count, limit)).round().astype(np.int64))
