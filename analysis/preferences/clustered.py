"""A mean with an interval when answers share participants and segments."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.clustered_variance import clustered_variance

LEVEL: Final = 0.95
"""Confidence level of every interval in the report."""


@dataclass(frozen=True, kw_only=True)
class ClusteredMean:
    """A mean of answers, its interval and its test.

    Attributes
    ----------
    estimate : float
        Mean of the values; NaN without any.
    standard_error : float
        Clustered standard error; NaN where it cannot be estimated.
    low, high : float
        Ends of the interval at `LEVEL`, cut to where values can lie; NaN where there is none.
    p_value : float
        Two-sided p of the mean being `null`; NaN where there is no standard error.
    answers, participants, segments : int
        What the estimate rests on.
    method : str
        Which variance was used; empty where there is none.
    reason : str
        Why there is no interval; empty where there is one.
    """

    estimate: float
    standard_error: float
    low: float
    high: float
    p_value: float
    answers: int
    participants: int
    segments: int
    method: str = ""
    reason: str = ""


def clustered_mean(
    values: NDArray[np.float64],
    participants: NDArray[np.generic],
    segments: NDArray[np.generic],
    *,
    null: float = 0.5,
    limits: tuple[float, float] = (0.0, 1.0),
) -> ClusteredMean:
    """Return the mean of `values` with an interval clustered by participant and segment.

    The variance is that of `clustered_variance`; the quantiles are those of t with
    min(participants, segments) - 1 degrees of freedom.

    Parameters
    ----------
    values : ndarray, shape (N,)
        One value per answer.
    participants, segments : ndarray, shape (N,)
        Who gave the answer, and which segment it is about.
    null : float
        Mean under the hypothesis that is tested.
    limits : tuple of float
        The least and the greatest value that an answer can have.

    Returns
    -------
    ClusteredMean
        Without an interval, and with the reason, where there are no answers, one participant,
        one segment, or all answers alike.
    """
    people = np.unique(participants, return_inverse=True)[1]
    items = np.unique(segments, return_inverse=True)[1]
    unknown = ClusteredMean(
        estimate=float(np.mean(values)) if len(values) else math.nan,
        standard_error=math.nan,
        low=math.nan,
        high=math.nan,
        p_value=math.nan,
        answers=len(values),
        participants=int(people.max(initial=-1)) + 1,
        segments=int(items.max(initial=-1)) + 1,
    )
    reason = _why_no_interval(values, unknown.participants, unknown.segments)
    if reason:
        return replace(unknown, reason=reason)
    influences = (values - unknown.estimate) / len(values)
    variance, method = clustered_variance(influences, people, items)
    error = math.sqrt(variance)
    law = stats.t(min(unknown.participants, unknown.segments) - 1)
    margin = float(law.ppf((1 + LEVEL) / 2)) * error
    return replace(
        unknown,
        standard_error=error,
        low=max(limits[0], unknown.estimate - margin),
        high=min(limits[1], unknown.estimate + margin),
        p_value=float(2 * law.sf(abs(unknown.estimate - null) / error)),
        method=method,
    )


def _why_no_interval(values: NDArray[np.float64], participants: int, segments: int) -> str:
    if not len(values):
        return "no answers"
    if participants < 2:
        return "one participant"
    if segments < 2:
        return "one segment"
    if np.ptp(values) == 0:
        return "all answers alike"
    return ""
