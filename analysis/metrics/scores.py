"""The scores of metrics: of a clip, of a condition and of a study, each with its settings."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal

import numpy as np

from motion.errors import InputError

Better = Literal["lower", "higher", "near the reference", "unsaid"]
"""Which of two scores is better: 'near the reference' if too much is as bad as too little, 'unsaid'
for numbers that only help to interpret others."""


@dataclass(frozen=True, kw_only=True)
class Score:
    """One number of one metric.

    Attributes
    ----------
    name : str
        The metric and, if there are several, its preset.
    value : float
        The score; NaN if undefined.
    unit : str
        Unit of `value`; empty if it has none.
    settings : mapping of str to str
        Everything that another score must share to be comparable with this one.
    reason : str
        Why `value` is NaN, or why clips have no score; empty if nothing is missing.
    interval : (float, float) or None
        95% interval of `value`; `settings` say how it was made.
    remark : str
        A caution about `value`, such as too small a sample.
    better : {'lower', 'higher', 'near the reference', 'unsaid'}
        Which scores are better; `analysis.report.sections.metrics` shows what papers state.
    """

    name: str
    value: float
    unit: str
    settings: Mapping[str, str] = field(default_factory=dict)
    reason: str = ""
    interval: tuple[float, float] | None = None
    remark: str = ""
    better: Better = "unsaid"


@dataclass(frozen=True, kw_only=True)
class MetricResult(Score):
    """The score of a clip, or of clips that were measured together, over `n` items."""

    n: int

    def __post_init__(self) -> None:
        if math.isnan(self.value) != bool(self.reason):
            raise ValueError(f"metric {self.name}: a reason belongs to NaN and to nothing else")
        if self.interval is not None and not self.interval[0] <= self.interval[1]:
            raise ValueError(f"metric {self.name}: {self.interval} is not an interval")


@dataclass(frozen=True)
class Metric:
    """The name of a score, its unit, and which scores are better."""

    name: str
    unit: str = ""
    better: Better = "unsaid"

    def score(
        self,
        value: float,
        n: int,
        settings: Mapping[str, str] | None = None,
        *,
        interval: tuple[float, float] | None = None,
        remark: str = "",
    ) -> MetricResult:
        """Return a score; see `MetricResult` for its parts."""
        return MetricResult(
            **vars(self),
            value=value,
            n=n,
            settings=settings or {},
            interval=interval,
            remark=remark,
        )

    def missing(self, reason: str, settings: Mapping[str, str] | None = None) -> MetricResult:
        """Return the result without a score, with the reason."""
        return MetricResult(
            **vars(self), value=math.nan, n=0, settings=settings or {}, reason=reason
        )


@dataclass(frozen=True, kw_only=True)
class EmotionConfusion:
    """The emotions that a network named for the gestures of one condition.

    Attributes
    ----------
    condition : str
        The condition.
    network : str
        Hash of the network's file.
    spoken : tuple of str
        Emotions of the speech, in the order of the network's labels, with at least one clip each.
    named : tuple of str
        All emotions that the network classifies.
    counts : tuple of tuple of int
        Clips by spoken emotion (rows) and named emotion (columns).
    """

    condition: str
    network: str
    spoken: tuple[str, ...]
    named: tuple[str, ...]
    counts: tuple[tuple[int, ...], ...]


@dataclass(frozen=True, kw_only=True)
class ClipScore:
    """One metric of one clip."""

    condition: str
    segment: str
    result: MetricResult


@dataclass(frozen=True, kw_only=True)
class ConditionScore(Score):
    """One metric of one condition: the mean over its clips, or the score of all together.

    Attributes
    ----------
    condition : str
        The condition.
    spread : float
        Standard deviation over the clips with a score; NaN for fewer than two and for a score of
        the whole condition.
    scored, clips : int
        Clips with a score, and all clips.
    """

    condition: str
    spread: float
    scored: int
    clips: int


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
    skipped : tuple of InputError
        About files that could not be used.
    notes : tuple of str
        On files that were read, such as a damaged face file next to one; not stored.
    remarks : tuple of str
        About segments without speech or a recording, for which metrics are missing.
    confusions : tuple of EmotionConfusion
        By emotion network, then condition: the emotions named for gestures.
    """

    frame_rate: float
    clips: tuple[ClipScore, ...]
    conditions: tuple[ConditionScore, ...]
    skipped: tuple[InputError, ...] = ()
    notes: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    confusions: tuple[EmotionConfusion, ...] = ()


_REASONS: Final = 3
"""Number of different reasons that are listed; every clip may have its own."""


def whole_condition(condition: str, result: MetricResult, clips: int) -> ConditionScore:
    """Return the score of a condition whose clips were measured together."""
    return ConditionScore(
        **{name: value for name, value in vars(result).items() if name != "n"},
        condition=condition,
        spread=math.nan,
        scored=0 if result.reason else clips,
        clips=clips,
    )


def clip_means(condition: str, scores: Sequence[ClipScore]) -> Iterator[ConditionScore]:
    """Yield the mean over clips of each metric, in the order in which the first clip has them."""
    by_name: dict[str, list[MetricResult]] = {}
    for score in scores:
        by_name.setdefault(score.result.name, []).append(score.result)
    for results in by_name.values():
        values = np.array([result.value for result in results if not result.reason])
        yield replace(
            whole_condition(condition, results[0], len(results)),
            value=float(values.mean()) if len(values) else math.nan,
            spread=float(values.std(ddof=1)) if len(values) > 1 else math.nan,
            scored=len(values),
            reason=counted([result.reason for result in results if result.reason], len(results)),
            remark="",
            interval=None,
        )


def counted(reasons: Sequence[str], clips: int) -> str:
    """Return each reason once, with its number of clips; only the first few of many reasons."""
    different = list(dict.fromkeys(reasons))
    named = [
        f"{reason} ({reasons.count(reason)} of {clips} clips)" for reason in different[:_REASONS]
    ]
    if len(different) > _REASONS:
        remaining = sum(reasons.count(reason) for reason in different[_REASONS:])
        named.append(f"and others like that ({remaining} of {clips} clips)")
    return "; ".join(named)
