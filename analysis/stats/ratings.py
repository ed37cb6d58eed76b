"""Ratings of each condition, and how much better one is rated than another: the headline.

A participant who rated both conditions in a segment gives one difference, and the mean of those
has a two-way clustered interval. It holds its level where the mixed model's contrast does not:
participants and segments may differ in which condition they favour, and segments may be few.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.clustered_mean import LEVEL, Clusters, Estimate, clustered_mean, with_interval
from analysis.stats.samples import finite
from motion.errors import InputError

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]

PAIRED: Final = "paired ratings"
UNPAIRED: Final = "all ratings, since few participants rated both conditions in one segment"

LEAST_PAIRED: Final = 0.5
"""Share of the ratings that must belong to pairs for the others to be left out."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RatedCells:
    """The mean rating of each participant, segment and condition.

    Attributes
    ----------
    means : ndarray, shape (cells, conditions)
        NaN where a condition was not rated.
    participants, segments : ndarray of int, shape (cells,)
        Whose, and of which segment.
    first : ndarray of int, shape (cells,)
        The first of each cell's ratings, by its place among all.
    """

    means: Floats
    participants: Codes
    segments: Codes
    first: Codes


def rated_cells(
    values: NDArray[np.number],
    conditions: Codes,
    participants: NDArray[np.generic],
    segments: NDArray[np.generic],
    *,
    count: int,
) -> RatedCells:
    """Arrange ratings so that those of one participant and segment stand beside one another.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Ratings as equally spaced numbers.
    conditions : ndarray of int, shape (N,)
        What was rated, from 0 to `count` - 1.
    participants, segments : ndarray, shape (N,)
        Who rated it, in which segment.
    count : int
        Number of conditions.
    """
    y = finite(values)
    who = np.unique(participants, return_inverse=True)[1]
    what = np.unique(segments, return_inverse=True)[1]
    width = int(what.max(initial=-1)) + 1
    cells, first, cell = np.unique(who * width + what, return_index=True, return_inverse=True)
    place = cell * count + conditions
    times = np.bincount(place, minlength=len(cells) * count)
    sums = np.bincount(place, weights=y, minlength=len(cells) * count)
    with np.errstate(invalid="ignore"):
        means = sums / times
    return RatedCells(
        means=means.reshape(len(cells), count),
        participants=cells // max(width, 1),
        segments=cells % max(width, 1),
        first=first,
    )


def mean_difference(cells: RatedCells, a: int, b: int) -> Estimate:
    """Return how much better condition `a` is rated than condition `b`, in scores.

    Where at least half of the ratings belong to pairs, it is the mean of the paired differences;
    `n` counts the pairs. Otherwise it is the difference of the two means.

    Returns
    -------
    Estimate
        Tested against zero, clustered as `clustered_mean`. `method` says which ratings and which
        variance it rests on.
    """
    there = ~np.isnan(cells.means[:, [a, b]])
    both = there.all(axis=1)
    if 2 * both.sum() < LEAST_PAIRED * there.sum():
        return _of_all(cells, [a, b], there)
    pairs = cells.means[both]
    found = clustered_mean(
        pairs[:, a] - pairs[:, b],
        cells.participants[both],
        cells.segments[both],
        null=0.0,
        limits=(-math.inf, math.inf),
    )
    if found.reason == "all answers alike":
        found = replace(found, reason="all pairs of ratings differ alike")
    return replace(found, method=f"{PAIRED}, {found.method}" if found.method else "")


def _of_all(cells: RatedCells, pair: Sequence[int], there: NDArray[np.bool_]) -> Estimate:
    """Return the difference of two means whose ratings do not belong together."""
    rows, column = np.nonzero(there)
    values = cells.means[rows, np.array(pair)[column]]
    clusters = Clusters.of(cells.participants[rows], cells.segments[rows])
    counts = np.bincount(column, minlength=2)
    if not counts.all():
        return clusters.unknown("one of the conditions has no ratings")
    means = np.bincount(column, weights=values) / counts
    found = replace(clusters.unknown(), estimate=float(means[0] - means[1]))
    if found.participants < 2:
        return replace(found, reason="one participant")
    influences = np.array([1.0, -1.0])[column] * (values - means[column]) / counts[column]
    if not influences.any():
        return replace(found, reason="all ratings of a condition alike")
    weights = counts[column].astype(np.float64) ** -2
    found = with_interval(found, influences, clusters, weights=weights)
    return replace(found, method=f"{UNPAIRED}, {found.method}")


def cliffs_delta(
    values: NDArray[np.number],
    of_first: NDArray[np.bool_],
    participants: NDArray[np.generic],
    segments: NDArray[np.generic],
) -> Estimate:
    """Compare the ratings of two conditions (Cliff 1993).

    The error is not Cliff's, who takes all ratings as independent: what each rating adds to
    delta is clustered by participant and segment as for a win share; interval and test are made on
    the scale of Fisher's z.

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
    clusters = Clusters.of(participants, segments)
    first, second = int(of_first.sum()), int((~of_first).sum())
    if not (first and second):
        return clusters.unknown("one of the conditions has no ratings")
    dominance = np.where(of_first, _above(y, y[~of_first]), -_above(y, y[of_first]))
    estimate = float(dominance[of_first].mean())
    found = replace(clusters.unknown(), estimate=estimate)
    if found.participants < 2:
        return replace(found, reason="one participant")
    if abs(estimate) == 1:
        return replace(found, reason="the ratings do not overlap")
    sizes = np.where(of_first, first, second).astype(np.float64)
    influences = (dominance - estimate) / sizes
    if not influences.any():
        return replace(found, reason="all ratings alike")
    found = with_interval(found, influences, clusters, weights=sizes**-2)
    law, middle = stats.t(found.df), math.atanh(estimate)
    error = found.standard_error / (1 - estimate**2)
    margin = float(law.ppf((1 + LEVEL) / 2)) * error
    return replace(
        found,
        low=math.tanh(middle - margin),
        high=math.tanh(middle + margin),
        p_value=float(2 * law.sf(abs(middle) / error)),
    )


def _above(values: Floats, others: Floats) -> Floats:
    """Return, for each value, the share of `others` below it minus the share above it."""
    order = np.sort(others)
    below = np.searchsorted(order, values, side="left")
    above = len(order) - np.searchsorted(order, values, side="right")
    return np.asarray((below - above) / len(order), np.float64)


@dataclass(frozen=True, kw_only=True)
class RatingSummary(Estimate):
    """The ratings of one condition: the estimate is their mean, tested against nothing.

    Attributes
    ----------
    condition : str
        Its name.
    sd : float
        Standard deviation of the single ratings; NaN for fewer than two.
    counts : mapping of int to int
        How often each score was given.
    at_least : mapping of int to float
        Ratings of this score or a higher one, in percent; NaN without any.
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
        In the order wanted; one without ratings gets a row that says so.
    scores : sequence of int
        All scores that can be given, ascending.
    limits : (float, float)
        Where intervals are cut: the ends of the scale, where it is known.

    Raises
    ------
    InputError
        If a rating is none of `scores`.
    """
    values = answers["value"].to_numpy()
    strange = ~np.isin(values, scores)
    if strange.any():
        raise InputError(
            f"a rating is {values[strange][0]:g}, which is not one of the scores "
            f"{', '.join(map(str, scores))}",
            remedy="Correct the rating, or name all scores of the scale",
        )
    return tuple(
        _summary(condition, answers[answers["condition"] == condition], scores, limits)
        for condition in conditions
    )


def _summary(
    condition: str,
    ratings: pd.DataFrame,
    scores: Sequence[int],
    limits: tuple[float, float],
) -> RatingSummary:
    values = ratings["value"].to_numpy(np.float64)
    counts = [int((values == score).sum()) for score in scores]
    above = np.cumsum(counts[::-1])[::-1]
    mean = clustered_mean(
        values,
        pd.factorize(ratings["participant"])[0],
        pd.factorize(ratings["segment"])[0],
        null=math.nan,
        limits=limits,
    )
    return RatingSummary(
        **vars(mean),
        condition=condition,
        sd=float(values.std(ddof=1)) if len(values) > 1 else math.nan,
        counts=dict(zip(scores, counts, strict=True)),
        at_least={
            score: 100 * int(count) / len(values) if len(values) else math.nan
            for score, count in zip(scores, above, strict=True)
        },
    )
