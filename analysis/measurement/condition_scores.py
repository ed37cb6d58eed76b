"""Scores of whole conditions: over all clips, and in the features of each network."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from analysis.evaluators.feature_networks import COMMANDS, Network
from analysis.measurement.feature_scores import (
    FeatureScores,
    feature_scores,
    scores_without_network,
)
from analysis.measurement.measured_clips import Setup
from analysis.measurement.segment_scores import (
    ClipMeasurements,
    SegmentFiles,
    SegmentScores,
    pose_settings,
)
from analysis.metrics.diversity import mean_pair_distance, motion_features
from analysis.metrics.scores import (
    ClipScore,
    ConditionScore,
    Metric,
    MetricResult,
    clip_means,
    whole_condition,
)
from motion.arrays import Floats32

_EXPRESSIONS: Final = "mean distance between clips (expressions)"

_FACES: Final = {52: "ARKit weights", 100: "SMPL-X expression coefficients"}


def recorded_conditions(
    conditions: Iterable[str], segments: Sequence[SegmentFiles]
) -> frozenset[str]:
    """Return the conditions whose motion is the recorded one."""
    return frozenset(
        condition
        for condition in conditions
        if all(
            files.clips[condition] == files.recorded
            for files in segments
            if condition in files.clips
        )
    )


def network_scores(
    network: Network,
    conditions: Iterable[str],
    measured: Sequence[SegmentScores],
    recordings: frozenset[str],
    emotions: Mapping[str, str],
) -> FeatureScores:
    """Return the scores of one network."""
    by_condition = {
        condition: {
            segment.segment: segment.clips[condition].features[network.name]
            for segment in measured
            if condition in segment.clips
        }
        for condition in conditions
    }
    recorded = {
        segment.segment: segment.recorded.features[network.name]
        for segment in measured
        if segment.recorded is not None
    }
    return feature_scores(
        network,
        {condition: clips for condition, clips in by_condition.items() if clips},
        recorded,
        recordings=recordings,
        emotions=emotions,
    )


def condition_scores(
    conditions: Sequence[str],
    scores: Sequence[ClipScore],
    measured: Sequence[SegmentScores],
    setup: Setup,
    by_network: Sequence[FeatureScores],
    recordings: Collection[str],
) -> Iterator[ConditionScore]:
    """Yield all scores of each condition: means over clips, distances, scores of networks."""
    available = {network.name.partition(", ")[0] for network in setup.networks}
    for condition in conditions:
        clips = [segment.clips[condition] for segment in measured if condition in segment.clips]
        yield from clip_means(condition, [s for s in scores if s.condition == condition])
        yield from distances(condition, clips, setup)
        for network in by_network:
            yield from (score for score in network.conditions if score.condition == condition)
        for name in setup.preset.networks:
            if name not in available:
                yield from scores_without_network(
                    name, COMMANDS[name], condition, len(clips), recorded=condition in recordings
                )


def distances(
    condition: str, clips: Sequence[ClipMeasurements], setup: Setup
) -> Iterator[ConditionScore]:
    """Yield the distances between the clips of a condition that the preset asks for."""
    bodies = [clip.upper_body for clip in clips if clip.upper_body is not None]
    if bodies:
        yield whole_condition(condition, _pair_distance(bodies, setup), len(bodies))
    if setup.preset.expression_distance and clips:
        faces = [clip.face for clip in clips if clip.face is not None]
        yield whole_condition(condition, _expression_distance(faces, setup), len(clips))


def _pair_distance(clips: Sequence[Floats32], setup: Setup) -> MetricResult:
    return mean_pair_distance(
        motion_features([clip.astype(np.float64) for clip in clips]),
        settings=pose_settings(setup.frame_rate)
        | {"distance": f"root mean square over frames and joints, {_cut(clips, setup.frame_rate)}"},
    )


def _cut(clips: Sequence[Floats32], frame_rate: float) -> str:
    return f"clips cut to the shortest, {min(map(len, clips)) / frame_rate:.2f} s"


def _expression_distance(clips: Sequence[Floats32], setup: Setup) -> MetricResult:
    kinds = {clip.shape[1] for clip in clips}
    reason = ""
    if "face" in setup.motion.frozen:
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
            "frame rate": f"{setup.face_rate:g} fps",
            "distance": f"root mean square over frames and weights, {_cut(clips, setup.face_rate)}",
        },
    )
