"""Scores of clips and of conditions, and files that could not be used."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from analysis.metrics.result import Better, EmotionConfusion, MetricResult
from motion.errors import InputError


@dataclass(frozen=True, kw_only=True)
class SkippedFile:
    """A file that could not be used.

    Attributes
    ----------
    what, where, remedy : str
        As in `motion.errors.InputError`.
    """

    what: str
    where: str
    remedy: str

    @classmethod
    def because(cls, error: InputError) -> SkippedFile:
        """Return the file that an error is about."""
        return cls(what=error.what, where=error.where, remedy=error.remedy)

    def error(self) -> InputError:
        """Return the error."""
        return InputError(self.what, where=self.where, remedy=self.remedy)


@dataclass(frozen=True, kw_only=True)
class ClipScore:
    """One metric of one clip."""

    condition: str
    segment: str
    result: MetricResult


@dataclass(frozen=True, kw_only=True)
class ConditionScore:
    """One metric of one condition.

    Attributes
    ----------
    condition, name, unit : str
        The condition, the metric and its unit.
    value : float
        Mean over the clips that have a score, or the score of the whole condition; NaN for none.
    spread : float
        Standard deviation over those clips; NaN for fewer than two and for a score of the whole
        condition.
    scored, clips : int
        Clips with a score, and all clips.
    settings : mapping of str to str
        As in `MetricResult`.
    reason : str
        Why clips have no score; empty if all have one.
    better : {'lower', 'higher', 'near the reference', 'unsaid'}
        Which scores are better; `analysis.report.sections.metrics` has what each paper
        says.
    interval : (float, float) or None
        95% interval of a score of the whole condition; `settings` say how it was made.
    remark : str
        A caution about `value`.
    """

    condition: str
    name: str
    unit: str
    value: float
    spread: float
    scored: int
    clips: int
    settings: Mapping[str, str]
    reason: str
    better: Better = "unsaid"
    interval: tuple[float, float] | None = None
    remark: str = ""


@dataclass(frozen=True, kw_only=True)
class StudyMetrics:
    """Everything measured: by clip, and by condition in the order the conditions were given.

    Attributes
    ----------
    frame_rate : float
        Frames per second at which clips were compared; NaN without clips.
    clips : tuple of ClipScore
        By condition, then segment.
    conditions : tuple of ConditionScore
        By condition.
    skipped : tuple of SkippedFile
        Files that could not be used.
    remarks : tuple of str
        Segments without speech or recording, so that metrics are missing.
    confusions : tuple of EmotionConfusion
        By emotion network, then condition: the emotions named for gestures.
    """

    frame_rate: float
    clips: tuple[ClipScore, ...]
    conditions: tuple[ConditionScore, ...]
    skipped: tuple[SkippedFile, ...] = ()
    remarks: tuple[str, ...] = ()
    confusions: tuple[EmotionConfusion, ...] = ()


_REASONS: Final = 3
"""Different reasons that are named; clips of different lengths may have one each."""


def whole_condition(condition: str, result: MetricResult, clips: int) -> ConditionScore:
    """Return the score of a condition whose `clips` were measured together."""
    return ConditionScore(
        condition=condition,
        name=result.name,
        unit=result.unit,
        value=result.value,
        spread=math.nan,
        scored=0 if result.reason else clips,
        clips=clips,
        settings=result.settings,
        reason=result.reason,
        better=result.better,
        interval=result.interval,
        remark=result.remark,
    )


def clip_means(condition: str, scores: Sequence[ClipScore]) -> Iterator[ConditionScore]:
    """Yield the mean over clips of each metric, in the order in which the first clip has them."""
    by_name: dict[str, list[MetricResult]] = {}
    for score in scores:
        by_name.setdefault(score.result.name, []).append(score.result)
    for name, results in by_name.items():
        values = np.array([result.value for result in results if not result.reason])
        yield ConditionScore(
            condition=condition,
            name=name,
            unit=results[0].unit,
            value=float(values.mean()) if len(values) else math.nan,
            spread=float(values.std(ddof=1)) if len(values) > 1 else math.nan,
            scored=len(values),
            clips=len(results),
            settings=results[0].settings,
            reason=counted([result.reason for result in results if result.reason], len(results)),
            better=results[0].better,
        )


def counted(reasons: Sequence[str], clips: int) -> str:
    """Return each reason once, with its number of clips; of many reasons, the first ones."""
    different = list(dict.fromkeys(reasons))
    named = [
        f"{reason} ({reasons.count(reason)} of {clips} clips)" for reason in different[:_REASONS]
    ]
    if len(different) > _REASONS:
        rest = sum(reasons.count(reason) for reason in different[_REASONS:])
        named.append(f"and others like that ({rest} of {clips} clips)")
    return "; ".join(named)
