"""Holm's correction for many tests, and the false positives of many looks."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from statistics import NormalDist
from typing import Final

import numpy as np

from motion.arrays import Floats


def holm(p_values: Sequence[float]) -> tuple[float, ...]:
    """Correct a declared family of p values by Holm's (1979) step-down method.

    A test that could not be made (NaN) still belongs to the family, so that a missing result never
    makes the others look more certain; its own corrected value is NaN.
    """
    return tuple(holm_rows(np.asarray(p_values, float)[None])[0].tolist())


def holm_rows(p_values: Floats) -> Floats:
    """Correct families of equal size, one in each row, shape (families, tests); see `holm`."""
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
"""Points of an integral: enough within one random step from one look to the next."""


def false_positive_rate(looks: Sequence[int]) -> float:
    """Return the false positive rate of stopping at the first look with p below `LEVEL`.

    The sum of participants' answers is assumed to be normal, and each participant to contribute
    equally. Then the sums at the looks are a random walk with normal steps, and the probability
    that it stays within the limits is integrated from look to look (Armitage, McPherson & Rowe
    1969).

    Parameters
    ----------
    looks : sequence of int
        Number of participants at each look, the final one included; above 0. Looks at equal numbers
        count once.

    Returns
    -------
    float
        In [`LEVEL`, 1); 0 without any look.
    """
    numbers = sorted(set(looks))
    limit = NormalDist().inv_cdf(1 - LEVEL / 2)
    # Positions of the walk after a look without a finding, and their probability masses.
    positions, masses = np.zeros(1), np.ones(1)
    previous = 0
    for number in numbers:
        step = math.sqrt(number - previous)
        nodes, weights = _nodes(limit * math.sqrt(number), step)
        density = np.exp(-(((nodes[:, None] - positions) / step) ** 2) / 2)
        masses = weights * (density @ masses) / (step * math.sqrt(2 * math.pi))
        positions, previous = nodes, number
    return 1 - float(masses.sum())


def _nodes(end: float, step: float) -> tuple[Floats, Floats]:
    """Return points and weights of an integral from `-end` to `end`, fine enough for `step`."""
    needed = NODES_PER_STEP * 2 * end / step
    count = FEWEST_NODES * math.ceil(needed / FEWEST_NODES)
    nodes, weights = _legendre(min(count, MOST_NODES))
    return end * nodes, end * weights


@cache
def _legendre(count: int) -> tuple[Floats, Floats]:
    """Return the points and weights of Gauss and Legendre, cached by count."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return nodes, weights


@dataclass(frozen=True, kw_only=True)
class Look:
    """One look, or several identical looks in a row.

    Attributes
    ----------
    day : str
        In UTC, as ``2026-05-04``.
    by : str
        ``researcher 1``, ``researcher 2`` …, or ``command line``.
    way : {'page', 'report', 'export'}
        The way in which results were seen.
    reason : str
        The reason in the researcher's words; empty if none was given.
    finished, planned : int
        Numbers of participants who had finished, and who were planned.
    answers : int
        Number of answers given so far.
    times : int
        Number of looks in a row.
    """

    day: str
    by: str
    way: str
    reason: str
    finished: int
    planned: int
    answers: int
    times: int = 1


@dataclass(frozen=True, kw_only=True)
class LooksBefore:
    """All looks at other answers than those reported.

    Attributes
    ----------
    count : int
        Number of looks.
    looks : tuple of Look
        In order of time.
    finished : tuple of int
        Numbers of participants who had finished at the looks, distinct and ascending.
    false_positive_rate : float
        False positive rate of stopping at the first of these looks that shows p below `level`, the
        reported answers being the last look. NaN without looks.
    level : float
        Level of each test.
    reason : str
        Why there is no rate.
    """

    count: int
    looks: tuple[Look, ...]
    finished: tuple[int, ...]
    false_positive_rate: float
    level: float
    reason: str


def looks_before(looks: Sequence[Look], *, finished: int, answers: int) -> LooksBefore:
    """Leave out looks at the reported answers, and judge the others.

    Parameters
    ----------
    looks : sequence of Look
        All logged looks, in order of time.
    finished, answers : int
        Numbers of finished participants and of answers in the report.
    """
    before = [look for look in looks if (look.finished, look.answers) != (finished, answers)]
    numbers = {look.finished for look in before if look.finished > 0}
    return LooksBefore(
        count=sum(look.times for look in before),
        looks=_gathered(before),
        finished=tuple(sorted({look.finished for look in before})),
        false_positive_rate=false_positive_rate(sorted(numbers | {finished}))
        if numbers and finished
        else math.nan,
        level=LEVEL,
        reason=_why_no_rate(before, bool(numbers and finished)),
    )


NOT_LOGGED: Final = LooksBefore(
    count=0,
    looks=(),
    finished=(),
    false_positive_rate=math.nan,
    level=LEVEL,
    reason="looks at a table of answers are not logged",
)
"""The looks of a table, and of a rehearsal."""


def _why_no_rate(before: Sequence[Look], is_known: bool) -> str:
    if is_known:
        return ""
    return "no participant had finished" if before else "no look is logged"


def _gathered(looks: Sequence[Look]) -> tuple[Look, ...]:
    """Merge identical looks in a row."""
    gathered: list[Look] = []
    for look in looks:
        if gathered and replace(gathered[-1], times=look.times) == look:
            gathered[-1] = replace(gathered[-1], times=gathered[-1].times + look.times)
        else:
            gathered.append(look)
    return tuple(gathered)
