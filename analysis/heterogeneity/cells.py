"""An effect within each emotion, segment or speaker, with its interval."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.preferences.clustered import LEVEL, ClusteredMean, clustered_mean

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]

FEW: Final = 3
"""Segments up to which a cell is described and not tested."""

ONE_SEGMENT: Final = "clustered by participant; of this segment alone"


@dataclass(frozen=True, kw_only=True)
class Cell:
    """The effect within one emotion, segment or speaker.

    Attributes
    ----------
    level : str
        Which one.
    mean : ClusteredMean
        The effect; its p is NaN where `descriptive`.
    descriptive : bool
        Whether it rests on so few segments that it says nothing about others of its kind.
    """

    level: str
    mean: ClusteredMean
    descriptive: bool


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
    count = len(np.unique(segments))
    if count == 1:
        return Cell(
            level=name, mean=_of_one_segment(values, participants, limits), descriptive=True
        )
    mean = clustered_mean(values, participants, segments, null=null, limits=limits)
    if count <= FEW:
        mean = replace(mean, p_value=math.nan)
    return Cell(level=name, mean=mean, descriptive=count <= FEW)


def _of_one_segment(
    values: Floats, participants: Codes, limits: tuple[float, float]
) -> ClusteredMean:
    """Return the mean over participants; it says nothing about other segments."""
    people, who, counts = np.unique(participants, return_inverse=True, return_counts=True)
    means = np.bincount(who, weights=values) / counts
    estimate = float(values.mean())
    found = ClusteredMean(
        estimate=estimate,
        standard_error=math.nan,
        low=math.nan,
        high=math.nan,
        p_value=math.nan,
        answers=len(values),
        participants=len(people),
        segments=1,
    )
    if len(people) < 2:
        return replace(found, reason="one participant")
    if not np.ptp(means):
        return replace(found, reason="all answers alike")
    error = float(means.std(ddof=1)) / math.sqrt(len(people))
    reach = float(stats.t(len(people) - 1).ppf((1 + LEVEL) / 2)) * error
    return replace(
        found,
        standard_error=error,
        low=max(limits[0], estimate - reach),
        high=min(limits[1], estimate + reach),
        method=ONE_SEGMENT,
    )
