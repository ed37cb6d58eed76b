"""Cliff's delta: how often one condition is rated higher than another, minus how often lower."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.clustered_variance import clustered_variance
from analysis.stats.finite import finite

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class CliffsDelta:
    """How far the ratings of two conditions lie apart.

    Attributes
    ----------
    estimate : float
        In [-1, 1]: 0 where neither is rated higher, 1 where all ratings of the first are higher
        than all of the second; NaN without ratings of both.
    standard_error : float
        Clustered; NaN where there is none.
    low, high : float
        Ends of its 95 % interval; NaN where there is none.
    first, second : int
        Number of ratings of each.
    participants, segments : int
        What the interval rests on.
    method : str
        Which variance was used; empty where there is none.
    reason : str
        Why there is no number or no interval; empty where there are both.
    """

    estimate: float
    standard_error: float
    low: float
    high: float
    first: int
    second: int
    participants: int
    segments: int
    method: str = ""
    reason: str = ""


def cliffs_delta(
    values: NDArray[np.number],
    of_first: NDArray[np.bool_],
    participants: NDArray[np.generic],
    segments: NDArray[np.generic],
) -> CliffsDelta:
    """Compare the ratings of two conditions (Cliff 1993).

    The error is not Cliff's, who takes all ratings as independent: what each rating adds to
    delta is clustered by participant and segment as for a win share; the interval is made on the
    scale of Fisher's z.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Ratings of two conditions.
    of_first : ndarray of bool, shape (N,)
        Which of them are of the first.
    participants, segments : ndarray, shape (N,)
        Who rated what.
    """
    y = finite(values)
    who = np.unique(participants, return_inverse=True)[1]
    what = np.unique(segments, return_inverse=True)[1]
    first, second = int(of_first.sum()), int((~of_first).sum())
    unknown = CliffsDelta(
        estimate=math.nan,
        standard_error=math.nan,
        low=math.nan,
        high=math.nan,
        first=first,
        second=second,
        participants=int(who.max(initial=-1)) + 1,
        segments=int(what.max(initial=-1)) + 1,
    )
    if not (first and second):
        return replace(unknown, reason="one of the conditions has no ratings")
    dominance = np.where(of_first, _above(y, y[~of_first]), -_above(y, y[of_first]))
    estimate = float(dominance[of_first].mean())
    found = replace(unknown, estimate=estimate)
    if found.participants < 2:
        return replace(found, reason="one participant")
    if abs(estimate) == 1:
        return replace(found, reason="the ratings do not overlap")
    influences = (dominance - estimate) / np.where(of_first, first, second)
    if not influences.any():
        return replace(found, reason="all ratings alike")
    spread = clustered_variance(
        influences, who, what, np.where(of_first, first, second).astype(np.float64) ** -2
    )
    error = math.sqrt(spread.variance)
    margin = float(stats.t(spread.freedom).ppf(0.975)) * error / (1 - estimate**2)
    middle = math.atanh(estimate)
    return replace(
        found,
        standard_error=error,
        low=math.tanh(middle - margin),
        high=math.tanh(middle + margin),
        method=spread.method,
    )


def _above(values: Floats, others: Floats) -> Floats:
    """Return, for each value, the share of `others` below it minus the share above it."""
    order = np.sort(others)
    below = np.searchsorted(order, values, side="left")
    above = len(order) - np.searchsorted(order, values, side="right")
    return np.asarray((below - above) / len(order), np.float64)
