"""A mean with an interval when answers share participants and segments."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.clustered_variance import clustered_variance, freedom_of

LEVEL: Final = 0.95
"""Confidence level of every interval in the report."""

EVEN: Final = 0.5
"""Share of the degrees of freedom of equally busy participants below which the report warns."""


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
    freedom : float
        Degrees of freedom of the standard error; NaN where there is none.
    method : str
        Which variance was used; empty where there is none.
    remark : str
        What limits the estimate: that one participant weighs much more than the others, and how
        far it moves without any one of them.
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
    freedom: float = math.nan
    method: str = ""
    remark: str = ""
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

    Variance and degrees of freedom are those of `clustered_variance`: of one segment, the
    interval is over participants alone.

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
        Without an interval, and with the reason, where there are no answers, one participant, or
        all answers alike.
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
    reason = _why_no_interval(values, unknown.participants)
    if reason:
        return replace(unknown, reason=reason)
    found = clustered_variance((values - unknown.estimate) / len(values), people, items)
    error, law = math.sqrt(found.variance), stats.t(found.freedom)
    margin = float(law.ppf((1 + LEVEL) / 2)) * error
    return replace(
        unknown,
        standard_error=error,
        low=max(limits[0], unknown.estimate - margin),
        high=min(limits[1], unknown.estimate + margin),
        p_value=float(2 * law.sf(abs(unknown.estimate - null) / error)),
        freedom=found.freedom,
        method=found.method,
        remark=_unequal(values, people),
    )


def _unequal(values: NDArray[np.float64], people: NDArray[np.intp]) -> str:
    """Say that participants answered very unequally often, and what hangs on one of them."""
    counts = np.bincount(people)
    if float(freedom_of(counts / len(values))) >= (len(counts) - 1) * EVEN:
        return ""
    without = (values.sum() - np.bincount(people, weights=values)) / (len(values) - counts)
    return (
        f"one participant gave {counts.max()} of {len(values)} answers; without any one "
        f"participant the estimate lies between {without.min():.3g} and {without.max():.3g}"
    )


def _why_no_interval(values: NDArray[np.float64], participants: int) -> str:
    if not len(values):
        return "no answers"
    if participants < 2:
        return "one participant"
    if np.ptp(values) == 0:
        return "all answers alike"
    return ""
