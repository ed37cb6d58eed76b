"""min F′: one test from a test over participants and a test over items."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.robustness.participant_means import group_means
from analysis.tied_ranks import ROUNDING

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class MinF:
    """Whether a mean differs from zero over participants and items at once.

    Attributes
    ----------
    estimate : float
        Mean of all answers; NaN without any.
    f_participants, f_items : float
        F of the test over participants' means and over items' means; infinite where those are
        all alike.
    statistic : float
        min F′, smaller than both: 1 / (1 / F1 + 1 / F2).
    freedom : float
        Its degrees of freedom in the denominator; 1 in the numerator.
    p_value : float
        Of min F′; NaN where there is no test.
    participants, items, answers : int
        What it rests on.
    reason : str
        Why there is no test; empty where there is one.
    """

    estimate: float
    f_participants: float
    f_items: float
    statistic: float
    freedom: float
    p_value: float
    participants: int
    items: int
    answers: int
    reason: str = ""


def min_f(values: Floats, participants: NDArray[np.generic], items: NDArray[np.generic]) -> MinF:
    """Test whether the mean of `values` is zero (Clark 1973).

    It is conservative: where there is no effect it finds one less often than in one case of
    twenty. F1 and F2 are the squares of the one-sample t over participants' and items' means.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Net preference of each answer, 0 for none.
    participants, items : ndarray, shape (N,)
        Who answered about what.
    """
    values = np.asarray(values, np.float64)
    by_participant, by_item = group_means(values, participants), group_means(values, items)
    unknown = MinF(
        estimate=float(values.mean()) if len(values) else math.nan,
        f_participants=math.nan,
        f_items=math.nan,
        statistic=math.nan,
        freedom=math.nan,
        p_value=math.nan,
        participants=len(by_participant),
        items=len(by_item),
        answers=len(values),
    )
    for count, one in ((len(by_participant), "participant"), (len(by_item), "segment")):
        if count < 2:
            return replace(unknown, reason=f"one {one}" if count else "no answers")
    noise_participants, noise_items = _noise(by_participant), _noise(by_item)
    found = replace(unknown, f_participants=_f(noise_participants), f_items=_f(noise_items))
    noise = noise_participants + noise_items
    if not values.any():
        return replace(unknown, reason="all answers are zero")
    if not noise:
        return replace(found, reason="all answers alike")
    if math.isinf(noise):
        smaller = min(found.participants, found.items)
        return replace(found, statistic=0.0, freedom=smaller - 1.0, p_value=1.0)
    freedom = noise**2 / (
        noise_participants**2 / (found.participants - 1) + noise_items**2 / (found.items - 1)
    )
    statistic = 1 / noise
    return replace(
        found,
        statistic=statistic,
        freedom=freedom,
        p_value=float(stats.f.sf(statistic, 1, freedom)),
    )


def _noise(means: Floats) -> float:
    """Return 1 / F: the variance of the mean in units of its square; infinite for a mean of 0."""
    centre, scale = float(means.mean()), float(np.abs(means).max())
    if abs(centre) <= ROUNDING * scale:
        return math.inf
    if float(np.ptp(means)) <= ROUNDING * scale:
        return 0.0
    return float(means.var(ddof=1)) / len(means) / centre**2


def _f(noise: float) -> float:
    return math.inf if noise == 0 else 1 / noise
