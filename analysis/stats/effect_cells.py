"""An effect within each emotion, segment or speaker, with its interval."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.stats.clustered_mean import UNTESTED, Estimate, clustered_mean

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]

FEW: Final = 3
"""Segments up to which a cell is described and not tested."""


@dataclass(frozen=True, kw_only=True)
class Cell(Estimate):
    """The effect within one emotion, segment or speaker.

    Attributes
    ----------
    level : str
        Which one.
    descriptive : bool
        Whether it rests on so few segments that it is described and not tested: it says nothing
        about others of its kind, and `p_value` is NaN.
    p_holm : float
        `p_value`, corrected over all such tests of a report.
    """

    level: str
    descriptive: bool
    p_holm: float = math.nan


def cells(
    values: Floats,
    levels: Codes,
    names: Sequence[str],
    participants: Codes,
    segments: Codes,
    *,
    null: float,
    limits: tuple[float, float] = (-math.inf, math.inf),
) -> tuple[Cell, ...]:
    """Estimate an effect within each level that has answers.

    Parameters
    ----------
    values : ndarray, shape (N,)
        One per answer; their mean is the effect.
    levels : ndarray of int, shape (N,)
        Which emotion, segment or speaker each is about, a place in `names`.
    names : sequence of str
        Of the levels.
    participants, segments : ndarray of int, shape (N,)
        Who answered about which segment.
    null : float
        The effect of none.
    limits : (float, float)
        Where values can lie.

    Returns
    -------
    tuple of Cell
        In the order of `names`.
    """
    order = np.argsort(levels, kind="stable")
    found, starts = np.unique(levels[order], return_index=True)
    return tuple(
        _cell(names[level], values[own], participants[own], segments[own], null, limits)
        for level, own in zip(found, np.split(order, starts[1:]), strict=True)
    )


def _cell(
    name: str,
    values: Floats,
    participants: Codes,
    segments: Codes,
    null: float,
    limits: tuple[float, float],
) -> Cell:
    mean = clustered_mean(values, participants, segments, null=null, limits=limits)
    count = mean.segments
    if descriptive := count <= FEW:
        untested = f"{count} segment{'s' * (count > 1)}: {UNTESTED}"
        remark = "; ".join(filter(None, (untested, mean.remark)))
        mean = replace(mean, p_value=math.nan, remark=remark)
    return Cell(**vars(mean), level=name, descriptive=descriptive)
