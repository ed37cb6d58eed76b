"""What was measured: scores of clips and of conditions, and files that could not be used."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from analysis.metrics.emotion_accuracy import EmotionConfusion
from analysis.metrics.result import Better, MetricResult
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
        """Return what `error` says."""
        return cls(what=error.what, where=error.where, remedy=error.remedy)

    def error(self) -> InputError:
        """Return the error that it was."""
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
        What was measured, on what.
    value : float
        Mean over the clips that have a score, or the score of the whole condition; NaN for none.
    spread : float
        Standard deviation over those clips; NaN for fewer than two and for a score of the whole
        condition.
    scored, clips : int
        Clips that have a score, and clips there are.
    settings : mapping of str to str
        As in `MetricResult`.
    reason : str
        Why clips have no score; empty where all have one.
    better : {'lower', 'higher', 'near the reference', 'unsaid'}
        Which scores speak for a condition; `analysis.measurement.paper_tables` has what each paper
        says.
    interval : (float, float) or None
        95 % interval of a score of the whole condition; `settings` say how it was made.
    remark : str
        What a reader must know before trusting `value`.
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
        What there was no speech or recording for, so that metrics are missing.
    confusions : tuple of EmotionConfusion
        By emotion network, then condition: which emotion gestures were taken for.
    """

    frame_rate: float
    clips: tuple[ClipScore, ...]
    conditions: tuple[ConditionScore, ...]
    skipped: tuple[SkippedFile, ...] = ()
    remarks: tuple[str, ...] = ()
    confusions: tuple[EmotionConfusion, ...] = ()
