"""The variance of an estimate when answers share participants and segments."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

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
