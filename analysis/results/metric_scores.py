"""What a metric says of conditions and of clips, so that more of it always speaks for them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.measurement.scores import StudyMetrics
from analysis.metrics.result import Better

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
