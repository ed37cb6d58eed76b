"""The variance of an estimate when answers share participants and items."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

TWO_WAY: Final = "clustered by participant and segment"
ONE_WAY_PARTICIPANTS: Final = "clustered by participant only, the larger variance"
ONE_WAY_SEGMENTS: Final = "clustered by segment only, the larger variance"
INDEPENDENT: Final = "answers as independent (no clustered variance is positive)"


def clustered_variance(
    influences: Floats, participants: NDArray[np.intp], segments: NDArray[np.intp]
) -> tuple[float, str]:
    """Return the variance of an estimate, clustered by participant and segment.

    It is the two-way cluster-robust one of Cameron, Gelbach & Miller (2011) with the CR1 factor
    G/(G-1) of each clustering. That variance is a difference and may come out too small, even
    negative; where a one-way variance is larger, the larger one takes its place (compare
    MacKinnon, Nielsen & Webb 2024).

    Parameters
    ----------
    influences : ndarray, shape (N,)
        What each answer adds to the estimate's error, to first order; they add up to zero. Those
        of a mean are (value - mean) / N.
    participants, segments : ndarray of int, shape (N,)
        Who gave the answer, and which segment it is about; from 0, at least two of each.

    Returns
    -------
    tuple of (float, str)
        The variance, and which one it is.
    """
    cells = np.unique(participants * (int(segments.max()) + 1) + segments, return_inverse=True)[1]
    by_participant, by_segment, by_cell = (
        _one_way(influences, groups) for groups in (participants, segments, cells)
    )
    independent = float(influences @ influences)
    return larger_variance(
        by_participant, by_segment, by_cell, independent, answers=len(influences)
    )


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


def _one_way(influences: Floats, groups: NDArray[np.intp]) -> float:
    sums = np.bincount(groups, weights=influences)
    count = len(sums)
    return float(sums @ sums) * count / (count - 1)
