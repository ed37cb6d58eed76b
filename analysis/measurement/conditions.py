"""Scores of whole conditions: means over clips, and distances between clips."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.measurement.clip_scores import pose_settings
from analysis.measurement.measured_clips import Bench
from analysis.measurement.scores import ClipScore, ConditionScore
from analysis.measurement.segment_scores import ClipFindings
from analysis.metrics.diversity import mean_pair_distance, motion_features
from analysis.metrics.result import Metric, MetricResult
from analysis.metrics.speed_histogram import Counts, speed_distance

_REASONS: Final = 3
"""Different reasons that are named; clips of different lengths have one each."""

_EXPRESSIONS: Final = "mean distance between clips (expressions)"

_FACES: Final = {52: "ARKit weights", 100: "SMPL-X expression coefficients"}


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
    """Return each reason once, with how many of all clips it holds for; of many, the first."""
    different = list(dict.fromkeys(reasons))
    named = [
        f"{reason} ({reasons.count(reason)} of {clips} clips)" for reason in different[:_REASONS]
    ]
    if len(different) > _REASONS:
        rest = sum(reasons.count(reason) for reason in different[_REASONS:])
        named.append(f"and others like that ({rest} of {clips} clips)")
    return "; ".join(named)


def distances(
    condition: str, clips: Sequence[ClipFindings], recorded_speeds: Sequence[Counts], bench: Bench
) -> Iterator[ConditionScore]:
    """Yield the distances of a condition that the preset asks for.

    Parameters
    ----------
    condition, clips : str, sequence of ClipFindings
        Whose, and all its clips.
    recorded_speeds : sequence of ndarray
        Of the recordings; none for the recordings themselves.
    bench : Bench
        How the clips were measured.
    """
    bodies = [clip.upper_body for clip in clips if clip.upper_body is not None]
    if bodies:
        yield whole_condition(condition, _of_bodies(bodies, bench), len(bodies))
    if bench.preset.expression_distance and clips:
        faces = [clip.face for clip in clips if clip.face is not None]
        yield whole_condition(condition, _of_faces(faces, bench), len(clips))
    speeds = [clip.speeds for clip in clips if clip.speeds is not None]
    if speeds and recorded_speeds:
        result = speed_distance(
            np.stack(speeds), np.stack(recorded_speeds), frame_rate=bench.frame_rate
        )
        yield whole_condition(condition, result, len(speeds))


def _of_bodies(clips: Sequence[NDArray[np.float32]], bench: Bench) -> MetricResult:
    return mean_pair_distance(
        motion_features([clip.astype(np.float64) for clip in clips]),
        settings=pose_settings(bench.frame_rate)
        | {"distance": "root mean square over frames and joints, clips cut to the shortest"},
    )


def _of_faces(clips: Sequence[NDArray[np.float32]], bench: Bench) -> MetricResult:
    kinds = {clip.shape[1] for clip in clips}
    reason = ""
    if "face" in bench.motion.frozen:
        reason = "the study holds the face still"
    elif not clips:
        reason = "no clip has a face"
    elif len(kinds) > 1:
        reason = "some clips have ARKit weights and others SMPL-X coefficients"
    if reason:
        return Metric(_EXPRESSIONS, better="near the reference").missing(reason)
    return mean_pair_distance(
        motion_features([clip[..., None].astype(np.float64) for clip in clips]),
        name=_EXPRESSIONS,
        unit="",
        settings={
            "face": _FACES[kinds.pop()],
            "frame rate": f"{bench.face_rate:g} fps",
            "distance": "root mean square over frames and weights, clips cut to the shortest",
        },
    )
