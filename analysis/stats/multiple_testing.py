"""What many tests and many looks do to false positives, and Holm's correction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from statistics import NormalDist
from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def holm(p_values: Sequence[float]) -> tuple[float, ...]:
    """Correct a declared family of p values by Holm's (1979) step-down method.

    A test that could not be made (NaN) still counts as a member of the family, so that a missing
    result never makes the others look more certain; its own corrected value is NaN.
    """
    return tuple(holm_rows(np.asarray(p_values, float)[None])[0].tolist())


def holm_rows(p_values: Floats) -> Floats:
    """Correct many families of equal size, one a row, shape (families, tests); see `holm`."""
    missing = np.isnan(p_values)
    tested = np.where(missing, 1.0, p_values)
    order = np.argsort(tested, axis=1, kind="stable")
    sizes = np.arange(tested.shape[1], 0, -1)
    steps = np.maximum.accumulate(np.take_along_axis(tested, order, axis=1) * sizes, axis=1)
    corrected = np.empty_like(tested)
    np.put_along_axis(corrected, order, np.minimum(1.0, steps), axis=1)
    return np.where(missing, np.nan, corrected)


LEVEL: Final = 0.05

FEWEST_NODES: Final = 64
NODES_PER_STEP: Final = 3
MOST_NODES: Final = 13 * FEWEST_NODES
"""Points of an integral: enough of them within what chance adds from one look to the next."""


def false_positive_rate(looks: Sequence[int]) -> float:
    """Return how often something is found where nothing is, if the first p below `LEVEL` ends it.

    The sum of what participants answer is taken for normal, and each participant for as much
    information as any other. Then the sums at the looks are a walk of independent normal steps,
    and the chance that it stays within the limits is integrated from look to look (Armitage,
    McPherson & Rowe 1969).

    Parameters
    ----------
    looks : sequence of int
        How many participants there were at each look, the last one included; above 0. Several
        looks at as many participants are one.

    Returns
    -------
    float
        In [`LEVEL`, 1); 0 without any look.

    Raises
    ------
    ValueError
        If a number of participants is not above 0.
    """
    numbers = sorted(set(looks))
    if not numbers:
        return 0.0
    if numbers[0] <= 0:
        raise ValueError("a look needs participants")
    limit = NormalDist().inv_cdf(1 - LEVEL / 2)
    # Where the walk may stand after a look without having been found, and how likely that is.
    positions, masses = np.zeros(1), np.ones(1)
    previous = 0
    for number in numbers:
        step = math.sqrt(number - previous)
        nodes, weights = _nodes(limit * math.sqrt(number), step)
        density = np.exp(-(((nodes[:, None] - positions) / step) ** 2) / 2)
        masses = weights * (density @ masses) / (step * math.sqrt(2 * math.pi))
        positions, previous = nodes, number
    return 1 - float(masses.sum())


def equally_spaced(looks: int) -> float:
    """Return the rate for so many looks, with as many new participants before each."""
    return false_positive_rate(range(1, looks + 1))


def _nodes(end: float, step: float) -> tuple[Floats, Floats]:
    """Return points and weights of an integral from `-end` to `end` over what varies by `step`."""
    needed = NODES_PER_STEP * 2 * end / step
    count = FEWEST_NODES * math.ceil(needed / FEWEST_NODES)
    nodes, weights = _legendre(min(count, MOST_NODES))
    return end * nodes, end * weights


@cache
def _legendre(count: int) -> tuple[Floats, Floats]:
    """Return the points and weights of Gauss and Legendre; there are few counts of them."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return nodes, weights
