"""Whether, within a condition, the clips that a metric praises are those that people prefer."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.results.drawn_preferences import Tallies
from analysis.results.metric_scores import MetricSide
from analysis.stats.clustered_mean import LEVEL, Interval

Floats = NDArray[np.float64]

FEWEST_SEGMENTS: Final = 6
"""With fewer, nothing tells how much the correlation varies between segments."""

_ROUNDING: Final = 1e-9


@dataclass(frozen=True, kw_only=True)
class WithinCorrelation(Interval):
    """Pearson's correlation over single clips, each measured from the mean of its condition.

    The interval is clustered by segment.

    Attributes
    ----------
    cells, segments, answers : int
        Clips (of pairwise comparisons, pairs of clips), segments and answers that it rests on.
    """

    cells: int
    segments: int
    answers: int


def within_conditions(found: Tallies, metric: MetricSide) -> WithinCorrelation:
    """Correlate scores with mean answers over clips, both measured from their group's mean.

    A group is a condition, or of pairwise comparisons a pair of conditions: there the difference
    of two scores is set beside the win share. Every clip weighs as much as it has answers. The
    interval leaves out one segment after the other (jackknife on Fisher's scale, t with
    segments - 1 degrees of freedom), since the clips of one segment share its speech.

    Parameters
    ----------
    found : Tallies
        The answers.
    metric : MetricSide
        One metric of the same conditions and segments.
    """
    if metric.clips is None:
        return _none("the metric scores whole conditions, not clips")
    if not len(metric.present):
        return _none("no condition has a usable score")
    sums, answers = found.cells
    scores = _scores_of_groups(found, metric, metric.clips)
    usable = (answers > 0) & ~np.isnan(scores)
    # A group with one clip has nothing to be measured from.
    usable &= (usable.sum(axis=1) > 1)[:, None]
    weights = np.where(usable, answers, 0)
    cells, segments = int(usable.sum()), int(usable.any(axis=0).sum())
    if segments < 2:
        return _none("fewer than two segments have scores and answers", cells, segments, weights)
    scores = np.where(usable, scores, 0)
    means = np.where(usable, sums / np.where(answers, answers, 1), 0)
    for values, what in ((scores, "scores"), (means, "answers")):
        if not _differ(values, weights):
            return _none(f"the {what} do not differ within conditions", cells, segments, weights)
    products = np.stack([weights * one for one in _products(scores, means)])
    estimate = float(_correlation(products.sum(axis=2)[..., None])[0])
    # Every segment in turn is left out.
    others = (products.sum(axis=2)[..., None] - products)[:, :, usable.any(axis=0)]
    low, high, reason = _interval(estimate, _correlation(others))
    return WithinCorrelation(
        estimate=estimate,
        low=low,
        high=high,
        cells=cells,
        segments=segments,
        answers=int(weights.sum()),
        reason=reason,
    )


def _scores_of_groups(found: Tallies, metric: MetricSide, clips: Floats) -> Floats:
    """Return what speaks for each group's clip, shape (G, segments); NaN where it is not known."""
    spoken = metric.speaking(clips, metric.recorded_clips).copy()
    spoken[list(metric.left_out)] = math.nan
    if found.groups.shape[1] == 1:
        return spoken[found.groups[:, 0]]
    return np.asarray(spoken[found.groups[:, 0]] - spoken[found.groups[:, 1]])


def _differ(values: Floats, weights: Floats) -> bool:
    """Tell whether values differ within any group by more than rounding errors."""
    total = weights.sum(axis=1, keepdims=True)
    means = (weights * values).sum(axis=1, keepdims=True) / np.where(total, total, 1)
    apart = np.abs(np.where(weights > 0, values - means, 0)).max()
    return bool(apart > _ROUNDING * np.abs(values).max())


def _products(first: Floats, second: Floats) -> tuple[Floats, ...]:
    """Return what sums must be known of: one, both values, their squares and their product."""
    # From the mean of all, so that the squares lose no digits.
    first, second = first - first.mean(), second - second.mean()
    return np.ones_like(first), first, second, first**2, second**2, first * second


def _correlation(sums: Floats) -> Floats:
    """Return the pooled correlation within groups from sums, shape (6, G, ...); NaN for none."""
    count, first, second, first_squares, second_squares, products = sums
    count = np.where(count > 0, count, 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        shared = (products - first * second / count).sum(axis=0)
        spread = (first_squares - first**2 / count).sum(axis=0)
        other_spread = (second_squares - second**2 / count).sum(axis=0)
        found = shared / np.sqrt(np.maximum(spread, 0) * np.maximum(other_spread, 0))
    return np.asarray(np.clip(found, -1, 1))


def _interval(estimate: float, without: Floats) -> tuple[float, float, str]:
    count = len(without)
    if count < FEWEST_SEGMENTS:
        return math.nan, math.nan, f"{count} segments are too few for an interval"
    if np.isnan(without).any() or np.abs([estimate, *without]).max() > 1 - _ROUNDING:
        return math.nan, math.nan, "but for one segment, scores and answers lie on a line"
    apart = np.arctanh(without) - np.arctanh(without).mean()
    error = math.sqrt((count - 1) / count * float(apart @ apart))
    margin = float(stats.t(count - 1).ppf((1 + LEVEL) / 2)) * error
    middle = math.atanh(estimate)
    return math.tanh(middle - margin), math.tanh(middle + margin), ""


def _none(
    reason: str, cells: int = 0, segments: int = 0, weights: Floats | None = None
) -> WithinCorrelation:
    answers = 0 if weights is None else int(weights.sum())
    return WithinCorrelation(cells=cells, segments=segments, answers=answers, reason=reason)
