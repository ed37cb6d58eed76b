"""Means and other estimates with intervals when answers share participants and segments."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Floats = NDArray[np.float64]

TWO_WAY: Final = "clustered by participant and segment"
ONE_WAY_PARTICIPANTS: Final = "clustered by participant only, the larger variance"
ONE_WAY_SEGMENTS: Final = "clustered by segment only, the larger variance"
ONE_SEGMENT: Final = "clustered by participant; of this segment alone"
INDEPENDENT: Final = "answers as independent (no clustered variance is positive)"


@dataclass(frozen=True, kw_only=True)
class ClusteredVariance:
    """A variance, and how well it is known.

    Attributes
    ----------
    variance : float
        Of the estimate; NaN where one group bears all of it.
    df : float
        Satterthwaite's degrees of freedom of the variance: of equal groups one less than there
        are, and fewer where some groups weigh more than others.
    method : str
        Which variance it is.
    """

    variance: float
    df: float
    method: str


def clustered_variance(
    influences: Floats,
    participants: NDArray[np.intp],
    segments: NDArray[np.intp],
    weights: Floats | None = None,
) -> ClusteredVariance:
    """Return the variance of an estimate, clustered by participant and segment.

    It is the two-way cluster-robust variance of Cameron, Gelbach & Miller (2011), each clustering
    corrected for small samples by CR2 (Bell & McCaffrey 2002). That variance is a difference and
    may come out too small, even negative; where a one-way variance is larger, the larger one
    takes its place (compare MacKinnon, Nielsen & Webb 2024). Where there is one segment, it is
    clustered by participant and says nothing about other segments.

    Parameters
    ----------
    influences : ndarray, shape (N,)
        What each answer adds to the estimate's error, to first order; they add up to zero. Those
        of a mean are (value - mean) / N.
    participants, segments : ndarray of int, shape (N,)
        Who gave the answer, and which segment it is about; from 0, at least two participants.
    weights : ndarray, shape (N,), optional
        The variance that each answer would add if answers were independent and alike, up to a
        factor; the same for all unless given.
    """
    by_participant, of_people = _way(influences, participants, weights)
    if not segments.any():
        return ClusteredVariance(variance=by_participant, df=of_people, method=ONE_SEGMENT)
    by_segment, of_segments = _way(influences, segments, weights)
    cells = np.unique(participants * (int(segments.max()) + 1) + segments, return_inverse=True)[1]
    by_cell, _ = _way(influences, cells, weights)
    variance, method = larger_variance(
        by_participant,
        by_segment,
        by_cell,
        float(influences @ influences),
        answers=len(influences),
    )
    return ClusteredVariance(variance=variance, df=min(of_people, of_segments), method=method)


def larger_variance(
    by_participant: float, by_segment: float, by_cell: float, independent: float, *, answers: int
) -> tuple[float, str]:
    """Return the two-way variance, or the one-way one that is larger, and which one it is.

    Parameters
    ----------
    by_participant, by_segment, by_cell : float
        Variances clustered one way: by participant, by segment, by both together.
    independent : float
        Sum of the squared influences.
    answers : int
        How many influences there are, at least two.
    """
    if math.isnan(by_participant + by_segment):
        return math.nan, ""
    variance, method = max(
        (by_participant + by_segment - by_cell, TWO_WAY),
        (by_participant, ONE_WAY_PARTICIPANTS),
        (by_segment, ONE_WAY_SEGMENTS),
        key=lambda found: found[0],
    )
    # Sums of rounding errors are no variance.
    if variance > 1e-12 * answers * independent:
        return variance, method
    return independent * answers / (answers - 1), INDEPENDENT


def one_way(sums: Floats, shares: Floats) -> tuple[Floats, Floats]:
    """Return a variance clustered one way, and its degrees of freedom; of one or many estimates.

    CR2 of an intercept: a group's residuals are too small by the square root of one minus its
    share.

    Parameters
    ----------
    sums : ndarray, shape (groups, ...)
        Each group's summed influences.
    shares : ndarray, shape (groups, ...)
        Each group's share of the weights; they add up to one.

    Returns
    -------
    tuple of ndarray
        NaN where one group bears all.
    """
    rest = np.where(shares > 1 - 1e-9, math.nan, 1 - shares)
    return np.asarray((sums**2 / rest).sum(axis=0)), freedom_of(shares)


def freedom_of(shares: Floats) -> Floats:
    """Return the degrees of freedom of a one-way variance of groups with these shares.

    They are those of Bell & McCaffrey (2002), for answers that are independent under the working
    model.
    """
    rest = np.where(shares > 1 - 1e-9, math.nan, 1 - shares)
    pulls = shares**2 / rest
    squares = (shares**2).sum(axis=0) + pulls.sum(axis=0) ** 2 - (pulls**2).sum(axis=0)
    return np.asarray(1 / squares)


def _way(
    influences: Floats, groups: NDArray[np.intp], weights: Floats | None
) -> tuple[float, float]:
    sizes = np.bincount(groups, weights=weights)
    variance, freedom = one_way(
        np.bincount(groups, weights=influences).astype(np.float64), sizes / sizes.sum()
    )
    return float(variance), float(freedom)


LEVEL: Final = 0.95
"""Confidence level of every interval in the report."""

UNTESTED: Final = "described, not tested"

EVEN: Final = 0.5
"""Share of the degrees of freedom of equally busy participants below which the report warns."""


@dataclass(frozen=True, kw_only=True)
class Interval:
    """An estimate and its interval; what there is none of is NaN.

    Attributes
    ----------
    estimate : float
        What is estimated.
    low, high : float
        Ends of the interval at `LEVEL`, cut to where values can lie.
    reason : str
        Why a number is missing; empty where none is.
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
        """Tell whether the interval holds `value`; False where there is none."""
        return self.low <= value <= self.high

    def mirrored(self, whole: float = 1.0) -> Self:
        """Return the same seen from the other side, whose share is the rest of the `whole`."""
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
        Two-sided p of there being no effect.
    n, participants, segments : int
        Answers, and who gave them about what.
    df : float
        Degrees of freedom of the standard error.
    method : str
        Which variance was used; empty where there is none.
    remark : str
        What limits the estimate, such as one participant who weighs much more than the others.
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
    """Who gave each answer, and which segment it is about, as numbers from 0."""

    participants: NDArray[np.intp]
    segments: NDArray[np.intp]

    @classmethod
    def of(cls, participants: NDArray[np.generic], segments: NDArray[np.generic]) -> Clusters:
        """Return names of participants and segments as numbers, shape (N,)."""
        return cls(
            np.unique(participants, return_inverse=True)[1],
            np.unique(segments, return_inverse=True)[1],
        )

    def unknown(self, reason: str = "") -> Estimate:
        """Return an estimate that is not there."""
        return Estimate(
            n=len(self.participants),
            participants=int(self.participants.max(initial=-1)) + 1,
            segments=int(self.segments.max(initial=-1)) + 1,
            reason=reason,
        )


def clustered_mean(
    values: NDArray[np.float64],
    participants: NDArray[np.generic],
    segments: NDArray[np.generic],
    *,
    null: float = 0.5,
    limits: tuple[float, float] = (0.0, 1.0),
) -> Estimate:
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
        Mean under the hypothesis that is tested; NaN for no test.
    limits : tuple of float
        The least and the greatest value that an answer can have.

    Returns
    -------
    Estimate
        Without an interval, and with the reason, where there are no answers, one participant, or
        all answers alike.
    """
    clusters = Clusters.of(participants, segments)
    unknown = clusters.unknown()
    if len(values):
        unknown = replace(unknown, estimate=float(np.mean(values)))
    reason = _why_no_interval(values, unknown.participants)
    if reason:
        return replace(unknown, reason=reason)
    influences = (values - unknown.estimate) / len(values)
    found = with_interval(unknown, influences, clusters, null=null)
    return replace(
        found,
        low=max(limits[0], found.low),
        high=min(limits[1], found.high),
        remark="; ".join(
            filter(None, (UNTESTED * math.isnan(null), _unequal(values, clusters.participants)))
        ),
    )


def with_interval(
    found: Estimate,
    influences: NDArray[np.float64],
    clusters: Clusters,
    *,
    weights: NDArray[np.float64] | None = None,
    null: float = 0.0,
) -> Estimate:
    """Return an estimate with its clustered interval, and its test against `null`.

    `influences` and `weights` are those of `clustered_variance`.
    """
    variance = clustered_variance(influences, clusters.participants, clusters.segments, weights)
    error, law = math.sqrt(variance.variance), stats.t(variance.df)
    margin = float(law.ppf((1 + LEVEL) / 2)) * error
    return replace(
        found,
        standard_error=error,
        low=found.estimate - margin,
        high=found.estimate + margin,
        p_value=float(2 * law.sf(abs(found.estimate - null) / error)),
        df=variance.df,
        method=variance.method,
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
