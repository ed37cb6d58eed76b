"""Ratings of each condition, and the difference between two conditions: the headline.

A participant who rated both conditions in a segment contributes one difference, and the mean of
these has a two-way clustered interval. It keeps its level where the mixed model's contrast does
not: if participants and segments differ in the condition that they favour, or segments are few.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.stats.clustered_mean import (
    Clusters,
    Estimate,
    clustered_mean,
    t_p_value,
    t_quantile,
    with_interval,
)
from motion.arrays import Bools, Floats, Indices

PAIRED: Final = "paired ratings"
UNPAIRED: Final = "all ratings, since few participants rated both conditions in one segment"

LEAST_PAIRED: Final = 0.5
"""Smallest share of ratings in pairs for which the other ratings are left out."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RatedCells:
    """The mean rating of each participant, segment and condition.

    Attributes
    ----------
    means : ndarray, shape (cells, conditions)
        NaN if a condition was not rated.
    participants, segments : ndarray of int, shape (cells,)
        The participant and the segment of each cell.
    first : ndarray of int, shape (cells,)
        Index of the first of each cell's ratings among all.
    """

    means: Floats
    participants: Indices
    segments: Indices
    first: Indices


def rated_cells(
    values: NDArray[np.number],
    conditions: Indices,
    participants: NDArray[np.generic],
    segments: NDArray[np.generic],
    *,
    count: int,
) -> RatedCells:
    """Arrange ratings by participant and segment, with a column for each condition.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Ratings as equally spaced numbers.
    conditions : ndarray of int, shape (N,)
        The condition rated, from 0 to `count` - 1.
    participants, segments : ndarray, shape (N,)
        The participant and the segment of each rating.
    count : int
        Number of conditions.
    """
    y = np.asarray(values, np.float64)
    clusters = Clusters.of(participants, segments)
    width = int(clusters.segments.max(initial=0)) + 1
    keys = clusters.participants * width + clusters.segments
    cells, first, cell = np.unique(keys, return_index=True, return_inverse=True)
    cells_of = cell * count + conditions
    counts = np.bincount(cells_of, minlength=len(cells) * count)
    sums = np.bincount(cells_of, weights=y, minlength=len(cells) * count)
    with np.errstate(invalid="ignore"):
        means = sums / counts
    return RatedCells(
        means=means.reshape(len(cells), count),
        participants=cells // width,
        segments=cells % width,
        first=first,
    )


def mean_difference(cells: RatedCells, a: int, b: int) -> Estimate:
    """Return how much better condition `a` is rated than condition `b`, in scores.

    If at least half of the ratings belong to pairs, it is the mean of the paired differences, and
    `n` counts the pairs. Otherwise it is the difference of the two means.

    Returns
    -------
    Estimate
        Tested against zero, clustered as in `clustered_mean`. `method` names the ratings and the
        variance.
    """
    rated = ~np.isnan(cells.means[:, [a, b]])
    paired = rated.all(axis=1)
    if 2 * paired.sum() < LEAST_PAIRED * rated.sum():
        return _of_all(cells, [a, b], rated)
    pairs = cells.means[paired]
    difference = clustered_mean(
        pairs[:, a] - pairs[:, b],
        cells.participants[paired],
        cells.segments[paired],
        null=0.0,
        limits=(-math.inf, math.inf),
    )
    if difference.reason == "all answers alike":
        difference = replace(difference, reason="all pairs of ratings differ by the same amount")
    return replace(difference, method=f"{PAIRED}, {difference.method}" if difference.method else "")


def _of_all(cells: RatedCells, pair: Sequence[int], rated: Bools) -> Estimate:
    """Return the difference of two means of unpaired ratings."""
    rows, column = np.nonzero(rated)
    values = cells.means[rows, np.array(pair)[column]]
    clusters = Clusters.of(cells.participants[rows], cells.segments[rows])
    counts = np.bincount(column, minlength=2)
    means = np.bincount(column, weights=values) / counts
    difference = replace(clusters.unknown(), estimate=float(means[0] - means[1]))
    if difference.participants < 2:
        return replace(difference, reason="one participant")
    influences = np.array([1.0, -1.0])[column] * (values - means[column]) / counts[column]
    if not influences.any():
        return replace(difference, reason="all ratings of a condition alike")
    weights = counts[column].astype(np.float64) ** -2
    difference = with_interval(difference, influences, clusters, weights=weights)
    return replace(difference, method=f"{UNPAIRED}, {difference.method}")


def cliffs_delta(
    values: NDArray[np.number],
    of_first: Bools,
    participants: NDArray[np.generic],
    segments: NDArray[np.generic],
) -> Estimate:
    """Compare the ratings of two conditions (Cliff 1993).

    The error is not Cliff's, who treats all ratings as independent: each rating's contribution to
    delta is clustered by participant and segment as for a win share, and interval and test are on
    the scale of Fisher's z.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Ratings of two conditions.
    of_first : ndarray of bool, shape (N,)
        Mask of the ratings of the first condition.
    participants, segments : ndarray, shape (N,)
        The participant and the segment of each rating.
    """
    y = np.asarray(values, np.float64)
    clusters = Clusters.of(participants, segments)
    first, second = int(of_first.sum()), int((~of_first).sum())
    dominance = np.where(of_first, _above(y, y[~of_first]), -_above(y, y[of_first]))
    estimate = float(dominance[of_first].mean())
    delta = replace(clusters.unknown(), estimate=estimate)
    if delta.participants < 2:
        return replace(delta, reason="one participant")
    if abs(estimate) == 1:
        return replace(delta, reason="the ratings do not overlap")
    sizes = np.where(of_first, first, second).astype(np.float64)
    influences = (dominance - estimate) / sizes
    if not influences.any():
        return replace(delta, reason="all ratings alike")
    delta = with_interval(delta, influences, clusters, weights=sizes**-2)
    z = math.atanh(estimate)
    error = delta.standard_error / (1 - estimate**2)
    margin = float(t_quantile(delta.df)) * error
    return replace(
        delta,
        low=math.tanh(z - margin),
        high=math.tanh(z + margin),
        p_value=float(t_p_value(z / error, delta.df)),
    )


def _above(values: Floats, others: Floats) -> Floats:
    """Return, for each value, the share of `others` below it minus the share above it."""
    order = np.sort(others)
    below = np.searchsorted(order, values, side="left")
    above = len(order) - np.searchsorted(order, values, side="right")
    return np.asarray((below - above) / len(order), np.float64)


@dataclass(frozen=True, kw_only=True)
class RatingSummary(Estimate):
    """The ratings of one condition; the estimate is their mean, without a test.

    Attributes
    ----------
    condition : str
        The condition's name.
    sd : float
        Standard deviation of the single ratings; NaN for fewer than two.
    counts : mapping of int to int
        How often each score was given.
    at_least : mapping of int to float
        Percentage of ratings at or above each score.
    """

    condition: str
    sd: float
    counts: Mapping[int, int]
    at_least: Mapping[int, float]


def rating_table(
    answers: pd.DataFrame,
    conditions: Sequence[str],
    scores: Sequence[int],
    limits: tuple[float, float] = (-math.inf, math.inf),
) -> tuple[RatingSummary, ...]:
    """Summarise the ratings of one question.

    Parameters
    ----------
    answers : DataFrame
        Columns `participant`, `segment`, `condition` and `value`, one row per rating.
    conditions : sequence of str
        In the order of the result; each has ratings.
    scores : sequence of int
        All possible scores, ascending; every rating is one of them.
    limits : (float, float)
        Limits of the intervals: the ends of the scale, if known.
    """
    summaries = []
    for condition in conditions:
        ratings = answers[answers["condition"] == condition]
        values = ratings["value"].to_numpy(np.float64)
        counts = [int((values == score).sum()) for score in scores]
        above = np.cumsum(counts[::-1])[::-1].tolist()
        mean = clustered_mean(
            values,
            pd.factorize(ratings["participant"])[0],
            pd.factorize(ratings["segment"])[0],
            null=math.nan,
            limits=limits,
        )
        summaries.append(
            RatingSummary(
                **vars(mean),
                condition=condition,
                sd=float(values.std(ddof=1)) if len(values) > 1 else math.nan,
                counts=dict(zip(scores, counts, strict=True)),
                at_least={s: 100 * n / len(values) for s, n in zip(scores, above, strict=True)},
            )
        )
    return tuple(summaries)
