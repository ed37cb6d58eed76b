"""A mean with its two-way clustered interval, as `results.json` holds it."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.stats.clustered_mean import ClusteredMean


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A mean with its two-way clustered interval, as `results.json` holds it.

    Attributes
    ----------
    estimate, low, high, se, p : float
        NaN where there is none.
    n, participants, segments : int
        What it rests on.
    df : float
        Degrees of freedom of the standard error.
    method, remark, reason : str
        Which variance was used; what limits the estimate; why there is no interval.
    """

    estimate: float
    low: float
    high: float
    se: float
    p: float
    n: int
    participants: int
    segments: int
    df: float
    method: str
    remark: str
    reason: str


def estimate_of(mean: ClusteredMean) -> Estimate:
    """Return a clustered mean under the names of `results.json`."""
    return Estimate(
        estimate=mean.estimate,
        low=mean.low,
        high=mean.high,
        se=mean.standard_error,
        p=mean.p_value,
        n=mean.answers,
        participants=mean.participants,
        segments=mean.segments,
        df=mean.freedom,
        method=mean.method,
        remark=mean.remark,
        reason=mean.reason,
    )
