"""All metrics of all conditions of a study, over the clips that participants saw."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.beat_alignment import PRESETS, beat_alignment
from analysis.metrics.diversity import l1_deviation, mean_pair_distance, motion_features
from analysis.metrics.jerk import HANDS, HANDS_UNFILTERED, jerk
from analysis.metrics.joint_positions import (
    UPPER_BODY_JOINTS,
    common_frame_rate,
    joint_positions,
    select,
)
from analysis.metrics.result import MetricResult
from motion.audio import read_audio
from motion.formats import read_clip
from motion.speech_onsets import DETECTOR, speech_onsets

FloatArray = NDArray[np.float64]
Excerpt = tuple[Path, float, float]
"""A recording, and where in it an excerpt starts and ends, in seconds."""

_JERKS: Final = (HANDS, HANDS_UNFILTERED)


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


@dataclass(frozen=True, kw_only=True)
class StudyMetrics:
    """Everything measured: by clip, and by condition in the order the conditions were given."""

    frame_rate: float
    clips: tuple[ClipScore, ...]
    conditions: tuple[ConditionScore, ...]


def study_metrics(
    clips: Mapping[str, Mapping[str, Path]],
    speech: Mapping[str, Excerpt],
    *,
    frozen: Collection[str] = (),
) -> StudyMetrics:
    """Measure the clips of every condition at one frame rate, on one body.

    Parameters
    ----------
    clips : mapping of condition to mapping of segment to path
        The study's own motion files.
    speech : mapping of segment to (recording, start, end)
        What each segment says; a segment without speech gets no beat alignment.
    frozen : collection of str
        Channels that the study holds still in its videos.

    Raises
    ------
    InputError
        If a motion or a recording cannot be read.
    """
    motions = {
        condition: {segment: read_clip(path) for segment, path in sorted(paths.items())}
        for condition, paths in clips.items()
    }
    rates = {clip.frame_rate for found in motions.values() for clip in found.values()}
    if not rates:
        return StudyMetrics(frame_rate=math.nan, clips=(), conditions=())
    frame_rate = common_frame_rate(rates)
    onsets = {segment: _onsets(excerpt) for segment, excerpt in sorted(speech.items())}
    by_clip: list[ClipScore] = []
    by_condition: list[ConditionScore] = []
    for condition, found in motions.items():
        positions = {
            segment: joint_positions(clip, frame_rate, frozen) for segment, clip in found.items()
        }
        scores = [
            ClipScore(condition=condition, segment=segment, result=result)
            for segment, moving in positions.items()
            for result in _clip_metrics(moving, onsets.get(segment), frame_rate)
        ]
        by_clip += scores
        by_condition += _summaries(condition, scores)
        by_condition += _pair_distance(condition, list(positions.values()), frame_rate)
    return StudyMetrics(frame_rate=frame_rate, clips=tuple(by_clip), conditions=tuple(by_condition))


def _onsets(excerpt: Excerpt) -> FloatArray:
    recording, start, end = excerpt
    return speech_onsets(read_audio(recording).cut(start, end))


def _clip_metrics(
    positions: FloatArray, onsets: FloatArray | None, frame_rate: float
) -> Iterator[MetricResult]:
    if onsets is not None:
        for preset in PRESETS:
            found = beat_alignment(
                select(positions, preset.joints),
                onsets,
                frame_rate=frame_rate,
                settings=preset,
                detector=DETECTOR,
            )
            yield from (found.above_chance, found.score, found.chance, found.motion_beats)
    for settings in _JERKS:
        measured = select(positions, settings.joints)
        yield jerk(measured, frame_rate=frame_rate, settings=settings)
    yield l1_deviation(select(positions, UPPER_BODY_JOINTS), settings=_pose_settings(frame_rate))


def _pair_distance(
    condition: str, clips: list[FloatArray], frame_rate: float
) -> Iterator[ConditionScore]:
    if not clips:
        return
    result = mean_pair_distance(
        motion_features([select(positions, UPPER_BODY_JOINTS) for positions in clips]),
        settings=_pose_settings(frame_rate)
        | {"distance": "root mean square over frames and joints, clips cut to the shortest"},
    )
    yield ConditionScore(
        condition=condition,
        name=result.name,
        unit=result.unit,
        value=result.value,
        spread=math.nan,
        scored=0 if result.reason else len(clips),
        clips=len(clips),
        settings=result.settings,
        reason=result.reason,
    )


def _pose_settings(frame_rate: float) -> dict[str, str]:
    return {
        "joints": ", ".join(UPPER_BODY_JOINTS),
        "frame rate": f"{frame_rate:g} fps",
        "positions": "relative to the pelvis, default body, metres",
    }


def _summaries(condition: str, scores: list[ClipScore]) -> Iterator[ConditionScore]:
    for name in dict.fromkeys(score.result.name for score in scores):
        results = [score.result for score in scores if score.result.name == name]
        values = np.array([result.value for result in results if not result.reason])
        reasons = [result.reason for result in results if result.reason]
        why = "; ".join(
            f"{reason} ({reasons.count(reason)} of {len(results)} clips)"
            for reason in dict.fromkeys(reasons)
        )
        yield ConditionScore(
            condition=condition,
            name=name,
            unit=results[0].unit,
            value=float(values.mean()) if len(values) else math.nan,
            spread=float(values.std(ddof=1)) if len(values) > 1 else math.nan,
            scored=len(values),
            clips=len(results),
            settings=results[0].settings,
            reason=why,
        )
