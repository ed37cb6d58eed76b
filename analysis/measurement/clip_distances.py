"""Distances of all clips of a condition: from each other, and of speeds from recorded ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.measurement.clip_scores import pose_settings
from analysis.measurement.conditions import ConditionScore, whole_condition
from analysis.measurement.measured_clips import Bench
from analysis.measurement.segment_scores import SegmentScores
from analysis.metrics.diversity import mean_pair_distance, motion_features
from analysis.metrics.result import Metric, MetricResult
from analysis.metrics.speed_histogram import speed_distance

EXPRESSIONS: Final = "mean distance between clips (expressions)"

_FACES: Final = {52: "ARKit weights", 100: "SMPL-X expression coefficients"}


def distances_between_clips(
    condition: str, measured: Sequence[SegmentScores], bench: Bench
) -> Iterator[ConditionScore]:
    """Yield the mean distances between a condition's clips that the preset asks for."""
    if bench.preset.pair_distance:
        bodies = [one.upper_bodies[condition] for one in measured if condition in one.upper_bodies]
        if bodies:
            yield whole_condition(condition, _of_bodies(bodies, bench), len(bodies))
    if bench.preset.expression_distance:
        faces = [one.faces[condition] for one in measured if condition in one.faces]
        clips = sum(condition in one.readable for one in measured)
        if clips:
            yield whole_condition(condition, _of_faces(faces, bench), clips)


def distances_of_speeds(
    condition: str, measured: Sequence[SegmentScores], bench: Bench
) -> Iterator[ConditionScore]:
    """Yield how far a condition's speeds are from those of all recordings, if it is asked for."""
    own = [one.speeds[condition] for one in measured if condition in one.speeds]
    recorded = [one.recorded_speeds for one in measured if one.recorded_speeds is not None]
    if own and recorded:
        result = speed_distance(np.stack(own), np.stack(recorded), frame_rate=bench.frame_rate)
        yield whole_condition(condition, result, len(own))


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
        return Metric(EXPRESSIONS, better="near the reference").missing(reason)
    return mean_pair_distance(
        motion_features([clip[..., None].astype(np.float64) for clip in clips]),
        name=EXPRESSIONS,
        unit="",
        settings={
            "face": _FACES[kinds.pop()],
            "frame rate": f"{bench.face_rate:g} fps",
            "distance": "root mean square over frames and weights, clips cut to the shortest",
        },
    )
