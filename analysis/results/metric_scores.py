"""Scores of a metric by condition and clip, and their correlation with answers within conditions.

Scores are oriented: the higher, the better.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.measurement.scores import StudyMetrics
from analysis.metrics.result import Better
from analysis.results.resampled_preferences import Tallies
from analysis.stats.clustered_mean import LEVEL, Interval

Floats = NDArray[np.float64]

ITSELF = "it is what the metric measures nearness to"
NOT_MEASURED = "the metric was not measured"
NOTHING_RECORDED = "recorded motion, which nearness is measured to, has no score"


@dataclass(frozen=True, kw_only=True, eq=False)
class OrientedMetric:
    """One metric of the conditions that people judged, whose scores can be oriented.

    Attributes
    ----------
    name, unit : str
        What was measured.
    better : {'lower', 'higher', 'near the reference'}
        Which scores are better.
    clips : ndarray, shape (conditions, segments), or None
        Score of each clip, NaN where there is none; None where only whole conditions have one.
    whole : ndarray, shape (conditions,)
        Score of each condition; the mean over its clips where there are any.
    recorded_clips, recorded : ndarray, shape (segments,), and float
        Scores of recorded motion where nearness to it counts; NaN otherwise.
    left_out : mapping of int to str
        Conditions without a usable score, and why.
    """

    name: str
    unit: str
    better: Better
    clips: Floats | None
    whole: Floats
    recorded_clips: Floats
    recorded: float
    left_out: Mapping[int, str]

    @property
    def present(self) -> NDArray[np.intp]:
        """The conditions that have a score."""
        return np.array([c for c in range(len(self.whole)) if c not in self.left_out], np.intp)

    def orient(self, scores: Floats, recorded: Floats | float) -> Floats:
        """Return scores of which higher ones are better."""
        match self.better:
            case "higher":
                return scores
            case "lower":
                return -scores
            case _:
                return -np.abs(scores - recorded)

    def resampled(self, segments: Floats) -> Floats:
        """Return the oriented scores of the conditions that have one, in resamples of segments.

        Parameters
        ----------
        segments : ndarray, shape (B, segments)
            How often each was drawn.

        Returns
        -------
        ndarray, shape (B, present conditions)
            NaN where no clip with a score was drawn. Scores of whole conditions stay as they are.
        """
        if self.clips is None:
            oriented = self.orient(self.whole[self.present], self.recorded)
            return np.broadcast_to(oriented, (len(segments), len(oriented)))
        means = _drawn_means(self.clips[self.present], segments)
        recorded: Floats | float = math.nan
        if self.better == "near the reference":
            recorded = _drawn_means(self.recorded_clips[None], segments)
        return self.orient(means, recorded)


def oriented_metrics(
    metrics: StudyMetrics,
    conditions: Sequence[str],
    segments: Sequence[str],
    recorded: str | None,
) -> tuple[OrientedMetric, ...]:
    """Return every metric that has a better direction, in the order of its first score.

    Parameters
    ----------
    metrics : StudyMetrics
        What was measured.
    conditions, segments : sequence of str
        What people judged.
    recorded : str or None
        The condition that is recorded motion.
    """
    by_clip: dict[str, dict[tuple[str, str], float]] = {}
    for clip in metrics.clips:
        by_clip.setdefault(clip.result.name, {})[clip.condition, clip.segment] = clip.result.value
    oriented: dict[str, OrientedMetric] = {}
    scores = {(score.name, score.condition): score for score in metrics.conditions}
    for score in metrics.conditions:
        if score.name in oriented or score.better == "unsaid":
            continue
        clip_values = by_clip.get(score.name)
        if clip_values is not None:
            clips = _table(clip_values, conditions, segments)
            recorded_clips = _table(clip_values, [recorded or ""], segments)[0]
            whole, reference = _means(clips), float(_means(recorded_clips[None])[0])
        else:
            clips, recorded_clips = None, np.full(len(segments), math.nan)
            values = {c: s.value for (name, c), s in scores.items() if name == score.name}
            whole = np.array([values.get(c, math.nan) for c in conditions])
            reference = values.get(recorded or "", math.nan)
        is_nearness = score.better == "near the reference"
        left_out = {}
        for number, condition in enumerate(conditions):
            if is_nearness and condition == recorded:
                left_out[number] = ITSELF
            elif is_nearness and math.isnan(reference):
                left_out[number] = NOTHING_RECORDED
            elif math.isnan(whole[number]):
                unscored = scores.get((score.name, condition))
                left_out[number] = (unscored.reason if unscored else "") or NOT_MEASURED
        oriented[score.name] = OrientedMetric(
            name=score.name,
            unit=score.unit,
            better=score.better,
            clips=clips,
            whole=whole,
            recorded_clips=recorded_clips,
            recorded=reference if is_nearness else math.nan,
            left_out=left_out,
        )
    return tuple(oriented.values())


def _table(
    values: Mapping[tuple[str, str], float], conditions: Sequence[str], segments: Sequence[str]
) -> Floats:
    return np.array([[values.get((c, s), math.nan) for s in segments] for c in conditions])


def _means(clips: Floats) -> Floats:
    """Return the mean over clips that have a score, NaN for none."""
    scored = ~np.isnan(clips)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(scored, clips, 0).sum(axis=1) / scored.sum(axis=1))


def _drawn_means(clips: Floats, segments: Floats) -> Floats:
    """Return means over drawn segments, shape (B, rows of clips)."""
    scored = ~np.isnan(clips)
    with np.errstate(invalid="ignore"):
        return np.asarray(
            segments @ np.where(scored, clips, 0).T / (segments @ scored.T.astype(np.float64))
        )


FEWEST_SEGMENTS: Final = 6
"""With fewer, it is not known how much the correlation varies between segments."""

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


def within_conditions(tallies: Tallies, metric: OrientedMetric) -> WithinCorrelation:
    """Correlate scores with mean answers over clips, both measured from their group's mean.

    A group is a condition, or of pairwise comparisons a pair of conditions: there the difference
    of two scores is correlated with the win share. Every clip weighs as much as it has answers.
    The interval is a jackknife over segments, whose clips share one speech (on Fisher's scale, t
    with segments - 1 degrees of freedom).

    Parameters
    ----------
    tallies : Tallies
        The answers.
    metric : OrientedMetric
        One metric of the same conditions and segments.
    """
    unknown = WithinCorrelation(cells=0, segments=0, answers=0)
    if metric.clips is None:
        return replace(unknown, reason="the metric scores whole conditions, not clips")
    if not len(metric.present):
        return replace(unknown, reason="no condition has a usable score")
    sums, answers = tallies.cells
    scores = _scores_of_groups(tallies, metric, metric.clips)
    usable = (answers > 0) & ~np.isnan(scores)
    # A group with one clip does not vary.
    usable &= (usable.sum(axis=1) > 1)[:, None]
    weights = np.where(usable, answers, 0)
    counted = WithinCorrelation(
        cells=int(usable.sum()),
        segments=int(usable.any(axis=0).sum()),
        answers=int(weights.sum()),
    )
    if counted.segments < 2:
        return replace(counted, reason="fewer than two segments have scores and answers")
    scores = np.where(usable, scores, 0)
    means = np.where(usable, sums / np.where(answers, answers, 1), 0)
    for values, name in ((scores, "scores"), (means, "answers")):
        if not _differ(values, weights):
            return replace(counted, reason=f"the {name} do not differ within conditions")
    products = np.stack([weights * product for product in _products(scores, means)])
    estimate = float(_correlation(products.sum(axis=2)[..., None])[0])
    without_each = (products.sum(axis=2)[..., None] - products)[:, :, usable.any(axis=0)]
    low, high, reason = _interval(estimate, _correlation(without_each))
    return replace(counted, estimate=estimate, low=low, high=high, reason=reason)


def _scores_of_groups(tallies: Tallies, metric: OrientedMetric, clips: Floats) -> Floats:
    """Return the oriented score of each group's clip, shape (G, segments); NaN where unknown."""
    oriented = metric.orient(clips, metric.recorded_clips).copy()
    oriented[list(metric.left_out)] = math.nan
    if tallies.groups.shape[1] == 1:
        return oriented[tallies.groups[:, 0]]
    return np.asarray(oriented[tallies.groups[:, 0]] - oriented[tallies.groups[:, 1]])


def _differ(values: Floats, weights: Floats) -> bool:
    """Tell whether values differ within any group by more than rounding errors."""
    totals = weights.sum(axis=1, keepdims=True)
    means = (weights * values).sum(axis=1, keepdims=True) / np.where(totals, totals, 1)
    deviation = np.abs(np.where(weights > 0, values - means, 0)).max()
    return bool(deviation > _ROUNDING * np.abs(values).max())


def _products(first: Floats, second: Floats) -> tuple[Floats, ...]:
    """Return the terms of a correlation: one, both values, their squares and their product."""
    # Centred, so that the squares lose no digits.
    first, second = first - first.mean(), second - second.mean()
    return np.ones_like(first), first, second, first**2, second**2, first * second


def _correlation(sums: Floats) -> Floats:
    """Return the pooled correlation within groups from sums, shape (6, G, ...); NaN for none."""
    count, first, second, first_squares, second_squares, products = sums
    count = np.where(count > 0, count, 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        covariance = (products - first * second / count).sum(axis=0)
        first_variance = (first_squares - first**2 / count).sum(axis=0)
        second_variance = (second_squares - second**2 / count).sum(axis=0)
        correlation = covariance / np.sqrt(
            np.maximum(first_variance, 0) * np.maximum(second_variance, 0)
        )
    return np.asarray(np.clip(correlation, -1, 1))


def _interval(estimate: float, without_each: Floats) -> tuple[float, float, str]:
    count = len(without_each)
    if count < FEWEST_SEGMENTS:
        return math.nan, math.nan, f"{count} segments are too few for an interval"
    if np.isnan(without_each).any() or np.abs([estimate, *without_each]).max() > 1 - _ROUNDING:
        return math.nan, math.nan, "but for one segment, scores and answers lie on a line"
    z = np.arctanh(without_each)
    error = math.sqrt((count - 1) / count * float(np.square(z - z.mean()).sum()))
    margin = float(stats.t(count - 1).ppf((1 + LEVEL) / 2)) * error
    centre = math.atanh(estimate)
    return math.tanh(centre - margin), math.tanh(centre + margin), ""
