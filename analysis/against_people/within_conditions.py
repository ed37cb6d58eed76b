"""Whether, within a condition, the clips that a metric praises are those that people prefer."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.against_people.metric_side import MetricSide
from analysis.against_people.result import WithinCorrelation
from analysis.against_people.tallies import Tallies
from analysis.preferences.clustered import LEVEL

Floats = NDArray[np.float64]

FEWEST_SEGMENTS: Final = 6
"""With fewer, nothing tells how much the correlation varies between segments."""

_NOTHING: Final = 1e-12


def within_conditions(found: Tallies, metric: MetricSide) -> WithinCorrelation:
    """Correlate scores with mean answers over clips, both measured from their group's mean.

    A group is a condition, or of pairwise comparisons a pair of conditions: there the difference
    of two scores is set beside the win share. Every clip weighs as much as it has answers. The
    interval is Fisher's, with an error clustered by segment (CR1, t with segments - 1 degrees of
    freedom), since the clips of one segment share its speech.

    Parameters
    ----------
    found : Tallies
        The answers.
    metric : MetricSide
        One metric of the same conditions and segments.
    """
    if metric.clips is None:
        return _none("the metric scores whole conditions, not clips")
    sums, answers = found.cells
    scores = _scores_of_groups(found, metric, metric.clips)
    usable = (answers > 0) & ~np.isnan(scores)
    # A group with one clip has nothing to be measured from.
    usable &= (usable.sum(axis=1) > 1)[:, None]
    weights = np.where(usable, answers, 0)
    cells, segments = int(usable.sum()), int(usable.any(axis=0).sum())
    if segments < 2:
        return _none("fewer than two segments have scores and answers", cells, segments, weights)
    first = _standardised(np.where(usable, scores, 0), weights)
    second = _standardised(np.where(usable, sums / np.where(answers, answers, 1), 0), weights)
    if not first.any():
        return _none("the scores do not differ within conditions", cells, segments, weights)
    if not second.any():
        return _none("the answers do not differ within conditions", cells, segments, weights)
    total = weights.sum()
    estimate = float(np.clip((weights * first * second).sum() / total, -1, 1))
    influences = weights * (first * second - estimate / 2 * (first**2 + second**2)) / total
    known = 1 + int(usable.any(axis=1).sum())
    # The means of the groups are estimated too (the factor of CR1 for that many coefficients).
    small = (cells - 1) / (cells - known) if cells > known else math.nan
    low, high, reason = _interval(estimate, influences.sum(axis=0)[usable.any(axis=0)], small)
    return WithinCorrelation(
        estimate=estimate,
        low=low,
        high=high,
        cells=cells,
        segments=segments,
        answers=int(total),
        reason=reason,
    )


def _scores_of_groups(found: Tallies, metric: MetricSide, clips: Floats) -> Floats:
    """Return what speaks for each group's clip, shape (G, segments); NaN where it is not known."""
    spoken = metric.speaking(clips, metric.recorded_clips).copy()
    spoken[list(metric.left_out)] = math.nan
    if found.groups.shape[1] == 1:
        return spoken[found.groups[:, 0]]
    return np.asarray(spoken[found.groups[:, 0]] - spoken[found.groups[:, 1]])


def _standardised(values: Floats, weights: Floats) -> Floats:
    """Return values from their groups' means, of variance one; zeros where they do not differ."""
    total = weights.sum(axis=1, keepdims=True)
    means = (weights * values).sum(axis=1, keepdims=True) / np.where(total, total, 1)
    centred = np.where(weights > 0, values - means, 0)
    spread = math.sqrt((weights * centred**2).sum() / weights.sum())
    if spread <= _NOTHING * float(np.abs(values).max()):
        return np.zeros_like(values)
    return np.asarray(centred / spread)


def _interval(estimate: float, by_segment: Floats, small: float) -> tuple[float, float, str]:
    count = len(by_segment)
    if count < FEWEST_SEGMENTS or math.isnan(small):
        return math.nan, math.nan, f"{count} segments are too few for an interval"
    if 1 - abs(estimate) < _NOTHING:
        return math.nan, math.nan, "scores and answers lie on a line"
    error = math.sqrt(small * count / (count - 1) * float(by_segment @ by_segment))
    # On Fisher's scale, whose slope is 1 / (1 - r²).
    margin = float(stats.t(count - 1).ppf((1 + LEVEL) / 2)) * error / (1 - estimate**2)
    middle = math.atanh(estimate)
    return math.tanh(middle - margin), math.tanh(middle + margin), ""


def _none(
    reason: str, cells: int = 0, segments: int = 0, weights: Floats | None = None
) -> WithinCorrelation:
    return WithinCorrelation(
        estimate=math.nan,
        low=math.nan,
        high=math.nan,
        cells=cells,
        segments=segments,
        answers=0 if weights is None else int(weights.sum()),
        reason=reason,
    )
