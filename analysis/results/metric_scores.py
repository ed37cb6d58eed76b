"""What a metric says of conditions and of clips, and whether clips that it praises are preferred.

It is turned so that more of it always speaks for what is measured.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.measurement.scores import StudyMetrics
from analysis.metrics.result import Better
from analysis.results.drawn_preferences import Tallies
from analysis.stats.clustered_mean import LEVEL, Interval

Floats = NDArray[np.float64]

ITSELF = "it is what the metric measures nearness to"
NOT_MEASURED = "the metric was not measured"
NOTHING_RECORDED = "recorded motion, which nearness is measured to, has no score"


@dataclass(frozen=True, kw_only=True, eq=False)
class MetricSide:
    """One metric of the conditions that people judged.

    Attributes
    ----------
    name, unit : str
        What was measured.
    better : {'lower', 'higher', 'near the reference'}
        Which scores speak for a condition.
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

    def speaking(self, scores: Floats, recorded: Floats | float) -> Floats:
        """Turn scores round where less is better; take their distance where nearness counts."""
        match self.better:
            case "higher":
                return scores
            case "lower":
                return -scores
            case _:
                return -np.abs(scores - recorded)

    def drawn(self, segments: Floats) -> Floats:
        """Return what speaks for the conditions that are present, in resamples of segments.

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
            spoken = self.speaking(self.whole[self.present], self.recorded)
            return np.broadcast_to(spoken, (len(segments), len(spoken)))
        means = _drawn_means(self.clips[self.present], segments)
        recorded: Floats | float = math.nan
        if self.better == "near the reference":
            recorded = _drawn_means(self.recorded_clips[None], segments)
        return self.speaking(means, recorded)


def metric_sides(
    metrics: StudyMetrics,
    conditions: Sequence[str],
    segments: Sequence[str],
    recorded: str | None,
) -> tuple[MetricSide, ...]:
    """Return every metric that calls a direction better, in the order of its first score.

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
    for one in metrics.clips:
        by_clip.setdefault(one.result.name, {})[one.condition, one.segment] = one.result.value
    found: dict[str, MetricSide] = {}
    scores = {(score.name, score.condition): score for score in metrics.conditions}
    for score in metrics.conditions:
        if score.name in found or score.better == "unsaid":
            continue
        own = by_clip.get(score.name)
        if own is not None:
            clips = _table(own, conditions, segments)
            recorded_clips = _table(own, [recorded or ""], segments)[0]
            whole, known = _means(clips), float(_means(recorded_clips[None])[0])
        else:
            clips, recorded_clips = None, np.full(len(segments), math.nan)
            values = {c: s.value for (name, c), s in scores.items() if name == score.name}
            whole = np.array([values.get(c, math.nan) for c in conditions])
            known = values.get(recorded or "", math.nan)
        near = score.better == "near the reference"
        left_out = {}
        for place, condition in enumerate(conditions):
            if near and condition == recorded:
                left_out[place] = ITSELF
            elif near and math.isnan(known):
                left_out[place] = NOTHING_RECORDED
            elif math.isnan(whole[place]):
                its = scores.get((score.name, condition))
                left_out[place] = (its.reason if its else "") or NOT_MEASURED
        found[score.name] = MetricSide(
            name=score.name,
            unit=score.unit,
            better=score.better,
            clips=clips,
            whole=whole,
            recorded_clips=recorded_clips,
            recorded=known if near else math.nan,
            left_out=left_out,
        )
    return tuple(found.values())


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
