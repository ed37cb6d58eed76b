"""Means and other estimates with intervals, for answers that share participants and segments."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray
from scipy import sparse, special

from motion.arrays import Floats, Indices

TWO_WAY: Final = "clustered by participant and segment"
ONE_WAY_PARTICIPANTS: Final = "clustered by participant only, the larger variance"
ONE_WAY_SEGMENTS: Final = "clustered by segment only, the larger variance"
ONE_SEGMENT: Final = "clustered by participant; of this segment alone"
INDEPENDENT: Final = "answers as independent (no clustered variance is positive)"


@dataclass(frozen=True, kw_only=True, eq=False)
class ClusteredVariance:
    """Variances of estimates, with their degrees of freedom.

    Attributes
    ----------
    variance : ndarray, shape (...)
        Variance of each estimate; NaN if a single group has all of the weight.
    df : ndarray, shape (...)
        Satterthwaite's degrees of freedom of the variances: for equal groups one less than their
        number, and fewer if some groups have more weight than others.
    method : ndarray of str, shape (...)
        The kind of each variance.
    """

    variance: Floats
    df: Floats
    method: NDArray[np.str_]


def clustered_variance(
    influences: Floats, participants: Indices, segments: Indices, weights: Floats | None = None
) -> ClusteredVariance:
    """Return the variances of estimates, clustered by participant and segment.

    This is the two-way cluster-robust variance of Cameron, Gelbach & Miller (2011), with each
    clustering corrected for small samples by CR2 (Bell & McCaffrey 2002). It is a difference and
    may come out too small, even negative; if a one-way variance is larger, the larger one replaces
    it (compare MacKinnon, Nielsen & Webb 2024). With one segment, it is clustered by participant
    alone and does not generalise to other segments.

    Parameters
    ----------
    influences : ndarray, shape (N,) or (N, estimates)
        Each answer's first-order contribution to the estimate's error; they sum to zero. For a mean
        they are (value - mean) / N.
    participants, segments : ndarray of int, shape (N,)
        The participant and the segment of each answer, from 0; at least two participants.
    weights : ndarray, shape (N,), optional
        Each answer's contribution to the variance if answers were independent and identically
        distributed, up to a factor; equal by default.
    """
    each = np.ones(len(influences))
    counts = [
        sparse.csr_array((each, (np.unique(groups, return_inverse=True)[1], np.arange(len(each)))))
        for groups in clusterings(participants, segments)
    ]
    weights = (each if weights is None else weights).reshape(-1, *[1] * (influences.ndim - 1))
    return variances(influences, weights, counts, each, one_segment=not np.ptp(segments))


def clusterings(participants: Indices, segments: Indices) -> list[Indices]:
    """Return groups by participant, by segment and by both; with one segment, by participant."""
    if not np.ptp(segments):
        return [participants] * 3
    return [participants, segments, participants * (int(segments.max()) + 1) + segments]


def variances(
    influences: Floats,
    weights: Floats,
    counts: Sequence[sparse.csr_array],
    answers: Floats | Indices,
    *,
    one_segment: bool,
) -> ClusteredVariance:
    """Return the variances of several estimates; without influences, 0 with NaN degrees.

    Parameters
    ----------
    influences, weights : ndarray, shape (kinds, ...)
        Influence and weight of an answer of each kind; see `clustered_variance`.
    counts : sequence of sparse array, shape (groups, kinds)
        Number of answers of each kind by the groups of `clusterings`.
    answers : ndarray, shape (kinds,)
        Number of answers of each kind.
    one_segment : bool
        Whether all answers are about one segment.
    """
    independent, total, number = answers @ influences**2, answers @ weights, answers.sum()
    total = np.where(total > 0, total, math.nan)
    (by_participant, df), (by_segment, df_of_segments), (by_cell, _) = (
        one_way(np.asarray(each @ influences, np.float64), (each @ weights) / total)
        for each in counts
    )
    candidates = np.stack([by_participant + by_segment - by_cell, by_participant, by_segment])
    variance = candidates.max(axis=0)
    two_way = ONE_SEGMENT if one_segment else TWO_WAY
    method = np.array([two_way, ONE_WAY_PARTICIPANTS, ONE_WAY_SEGMENTS])[candidates.argmax(axis=0)]
    is_rounding = variance <= 1e-12 * number * independent
    method = np.where(is_rounding, INDEPENDENT, np.where(np.isnan(variance), "", method))
    variance = np.where(is_rounding, independent * number / (number - 1), variance)
    return ClusteredVariance(
        variance=np.where(independent > 0, variance, 0.0),
        df=np.minimum(df, df_of_segments),
        method=np.where(independent > 0, method, ""),
    )


def one_way(sums: Floats, shares: Floats) -> tuple[Floats, Floats]:
    """Return variances clustered one way, and their degrees of freedom.

    CR2 for an intercept: a group's residuals are too small by the square root of one minus its
    share. The degrees of freedom are those of Bell & McCaffrey (2002), with independent answers as
    the working model.

    Parameters
    ----------
    sums : ndarray, shape (groups, ...)
        Each group's summed influences.
    shares : ndarray, shape (groups, ...)
        Each group's share of the weights; the shares sum to one.

    Returns
    -------
    tuple of ndarray
        NaN if one group has all of the weight.
    """
    others = np.where(shares > 1 - 1e-9, math.nan, 1 - shares)
    return np.asarray((sums**2 / others).sum(axis=0)), freedom_of(shares)


def freedom_of(shares: Floats) -> Floats:
    """Return the degrees of freedom of a one-way variance of groups with these shares."""
    others = np.where(shares > 1 - 1e-9, math.nan, 1 - shares)
    leverages = shares**2 / others
    squares = (shares**2).sum(axis=0) + leverages.sum(axis=0) ** 2 - (leverages**2).sum(axis=0)
    return np.asarray(1 / squares)


LEVEL: Final = 0.95
"""Confidence level of every interval in the report."""

UNTESTED: Final = "described, not tested"

EVEN: Final = 0.5
"""The report warns below this share of the degrees of freedom of equally active participants."""


@dataclass(frozen=True, kw_only=True)
class Interval:
    """An estimate and its interval; NaN if there is none.

    Attributes
    ----------
    estimate : float
        The estimate.
    low, high : float
        Ends of the interval at `LEVEL`, cut to the range of possible values.
    reason : str
        Why a number is missing; empty if none is.
    """

    estimate: float = math.nan
    low: float = math.nan
    high: float = math.nan
    reason: str = ""

    @property
    def has_interval(self) -> bool:
        """Whether there is an interval."""
        return not math.isnan(self.low)

    def covers(self, value: float) -> bool:
        """Return whether the interval contains `value`; False without an interval."""
        return self.low <= value <= self.high

    def mirrored(self, whole: float = 1.0) -> Self:
        """Return the interval of `whole` minus the estimate: the other side's share."""
        return replace(
            self, estimate=whole - self.estimate, low=whole - self.high, high=whole - self.low
        )


@dataclass(frozen=True, kw_only=True)
class Estimate(Interval):
    """A mean, a share or a difference, with its interval and its test.

    Attributes
    ----------
    standard_error : float
        Clustered by participant and segment.
    p_value : float
        Two-sided p for no effect.
    n, participants, segments : int
        Numbers of answers, participants and segments.
    df : float
        Degrees of freedom of the standard error.
    method : str
        The kind of variance; empty if there is none.
    remark : str
        A caution about the estimate, such as one participant who gave far more answers than others.
    """

    standard_error: float = math.nan
    p_value: float = math.nan
    n: int = 0
    participants: int = 0
    segments: int = 0
    df: float = math.nan
    method: str = ""
    remark: str = ""


@dataclass(frozen=True, eq=False)
class Clusters:
    """The participant and the segment of each answer, as numbers from 0."""

    participants: Indices
    segments: Indices

    @classmethod
    def of(cls, participants: NDArray[np.generic], segments: NDArray[np.generic]) -> Clusters:
        """Return the answers' participants and segments, given by name, as numbers."""
        return cls(
            np.unique(participants, return_inverse=True)[1],
            np.unique(segments, return_inverse=True)[1],
        )

    def unknown(self, reason: str = "") -> Estimate:
        """Return an estimate without numbers, and the reason."""
        return Estimate(
            n=len(self.participants),
            participants=int(self.participants.max(initial=-1)) + 1,
            segments=int(self.segments.max(initial=-1)) + 1,
            reason=reason,
        )


def clustered_mean(
    values: Floats,
    participants: NDArray[np.generic],
    segments: NDArray[np.generic],
    *,
    null: float = 0.5,
    limits: tuple[float, float] = (0.0, 1.0),
) -> Estimate:
    """Return the mean of `values` with an interval clustered by participant and segment.

    Variance and degrees of freedom are those of `clustered_variance`; with one segment, the
    interval is over participants alone.

    Parameters
    ----------
    values : ndarray, shape (N,)
        One value per answer.
    participants, segments : ndarray, shape (N,)
        The participant and the segment of each answer.
    null : float
        Mean under the null hypothesis; NaN for no test.
    limits : tuple of float
        The smallest and the largest possible value of an answer.

    Returns
    -------
    Estimate
        Without an interval, but with the reason, if there are no answers, one participant, or only
        equal answers.
    """
    clusters = Clusters.of(participants, segments)
    unknown = clusters.unknown()
    if len(values):
        unknown = replace(unknown, estimate=float(np.mean(values)))
    if reason := _why_no_interval(values, unknown.participants):
        return replace(unknown, reason=reason)
    influences = (values - unknown.estimate) / len(values)
    mean = with_interval(unknown, influences, clusters, null=null)
    return replace(
        mean,
        low=max(limits[0], mean.low),
        high=min(limits[1], mean.high),
        remark="; ".join(
            filter(None, (UNTESTED * math.isnan(null), _unequal(values, clusters.participants)))
        ),
    )


def t_quantile(df: Floats | float) -> Floats:
    """Return how many standard errors an interval reaches to each side of an estimate."""
    # Not of `scipy.stats.t`, which takes 200 times as long for one number.
    return np.asarray(special.stdtrit(df, (1 + LEVEL) / 2), np.float64)


def t_p_value(t: Floats | float, df: Floats | float) -> Floats:
    """Return the two-sided p value of `t`."""
    return np.asarray(2 * special.stdtr(df, -np.abs(t)), np.float64)


def with_interval(
    estimate: Estimate,
    influences: Floats,
    clusters: Clusters,
    *,
    weights: Floats | None = None,
    null: float = 0.0,
) -> Estimate:
    """Return an estimate with its clustered interval, and its test against `null`.

    `influences` and `weights` are those of `clustered_variance`.
    """
    variance = clustered_variance(influences, clusters.participants, clusters.segments, weights)
    error, df = math.sqrt(variance.variance), float(variance.df)
    margin = float(t_quantile(df)) * error
    return replace(
        estimate,
        standard_error=error,
        low=estimate.estimate - margin,
        high=estimate.estimate + margin,
        p_value=float(t_p_value((estimate.estimate - null) / error, df)),
        df=df,
        method=str(variance.method),
    )


def _unequal(values: Floats, participants: Indices) -> str:
    """Return a caution if participants answered very unequally often; '' otherwise."""
    counts = np.bincount(participants)
    if float(freedom_of(counts / len(values))) >= (len(counts) - 1) * EVEN:
        return ""
    without = (values.sum() - np.bincount(participants, weights=values)) / (len(values) - counts)
    return (
        f"one participant gave {counts.max()} of {len(values)} answers; without any one "
        f"participant the estimate lies between {without.min():.3g} and {without.max():.3g}"
    )


def _why_no_interval(values: Floats, participants: int) -> str:
    if not len(values):
        return "no answers"
    if participants < 2:
        return "one participant"
    if np.ptp(values) == 0:
        return "all answers alike"
    return ""
