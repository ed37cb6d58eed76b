"""All metrics of one clip."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from analysis.measurement.measured_clips import MeasuredClip, Setup
from analysis.measurement.recorded_spread import RecordedSpread
from analysis.metrics.beat_alignment import beat_alignment
from analysis.metrics.correct_motion import (
    CorrectSettings,
    percent_correct_motion,
    semantic_recall,
)
from analysis.metrics.diversity import l1_deviation
from analysis.metrics.joint_motion import GESTURE_JOINTS, UPPER_BODY_JOINTS, select
from analysis.metrics.kinematics import FEET, foot_sliding, mean_derivative
from analysis.metrics.point_errors import S2UE_FRAME_RATE, point_error, velocity_error
from analysis.metrics.result import MetricResult
from motion.audio_analysis import DETECTOR
from motion.formats.beat_tracks import SemanticSpan, semantic_weights
from motion.formats.ted_npz import JOINT_NAMES as TED_JOINTS

FloatArray = NDArray[np.float64]

_ON_THE_FACE: Final = {
    "positions": "on the mean shape of one body, the head held still",
    "box": "that of the recordings' landmarks",
}


def clip_metrics(
    clip: MeasuredClip,
    setup: Setup,
    *,
    onsets: FloatArray | None = None,
    recorded: MeasuredClip | None = None,
    semantics: tuple[SemanticSpan, ...] | None = None,
) -> Iterator[MetricResult]:
    """Yield every metric of the setup's preset that the given material allows.

    Parameters
    ----------
    clip : MeasuredClip
        The clip that is measured.
    setup : Setup
        How; without a spread of all recordings there is nothing that is normalised by them.
    onsets : ndarray or None
        Onsets of the speech in seconds; without them there is no beat alignment.
    recorded : MeasuredClip or None
        The recording of the same speech; without it there are no errors.
    semantics : tuple of SemanticSpan or None
        Which gestures carry meaning; without them there is no semantic recall.
    """
    positions, frame_rate, preset = clip.joints.relative, setup.frame_rate, setup.preset
    if onsets is not None:
        yield from _beats(positions, onsets, setup)
    for settings in preset.derivatives:
        measured = select(positions, settings.joints)
        yield mean_derivative(measured, frame_rate=frame_rate, settings=settings)
    if preset.mean_pose_deviation:
        yield l1_deviation(select(positions, UPPER_BODY_JOINTS), settings=pose_settings(frame_rate))
    if preset.foot_sliding:
        world = positions + clip.joints.pelvis[:, None]
        yield foot_sliding(select(world, FEET), frame_rate=frame_rate)
    if recorded is not None:
        yield from _correct(clip, recorded, setup, semantics)
        for norm in preset.velocity_errors:
            yield velocity_error(
                select(positions, UPPER_BODY_JOINTS),
                select(recorded.joints.relative, UPPER_BODY_JOINTS),
                frame_rate=frame_rate,
                norm=norm,
                settings=pose_settings(frame_rate),
            )
        yield from _joint_errors(positions, recorded.joints.relative, setup)
        yield from _landmark_errors(clip, recorded, setup)


def pose_settings(frame_rate: float) -> dict[str, str]:
    """Return what positions of the upper body are, in words."""
    return {
        "joints": ", ".join(UPPER_BODY_JOINTS),
        "frame rate": f"{frame_rate:g} fps",
        "positions": "relative to the pelvis, default body, metres",
    }


def _beats(positions: FloatArray, onsets: FloatArray, setup: Setup) -> Iterator[MetricResult]:
    for settings in setup.preset.beats:
        found = beat_alignment(
            select(positions, settings.joints),
            onsets,
            frame_rate=setup.frame_rate,
            settings=settings,
            detector=DETECTOR,
        )
        yield from (
            found.above_chance,
            found.score,
            found.opposite,
            found.chance,
            found.motion_beats,
        )


def _correct(
    clip: MeasuredClip,
    recorded: MeasuredClip,
    setup: Setup,
    semantics: tuple[SemanticSpan, ...] | None,
) -> Iterator[MetricResult]:
    for settings in setup.preset.correct:
        one, other = (_represented(side, settings, setup.spread) for side in (clip, recorded))
        if one is None or other is None:
            continue
        found = [percent_correct_motion(one, other, settings=settings)]
        if semantics is not None:
            weights = semantic_weights(semantics, max(len(one), len(other)), setup.frame_rate)
            found.append(semantic_recall(one, other, weights, settings=settings))
        rotated = settings.representation != "positions"
        measured = {
            "joints": ", ".join(GESTURE_JOINTS if rotated else UPPER_BODY_JOINTS),
            "frame rate": f"{setup.frame_rate:g} fps",
        }
        for result in found:
            yield replace(result, settings={**result.settings, **measured})


def _represented(
    clip: MeasuredClip, settings: CorrectSettings, spread: RecordedSpread | None
) -> FloatArray | None:
    """Return the motion in the representation of `settings`; None where that is not known."""
    if settings.representation == "positions":
        return select(clip.joints.relative, UPPER_BODY_JOINTS)
    if clip.rotations is None:
        return None
    if settings.representation == "normalised rotations":
        return None if spread is None else spread.normalised(clip.rotations)
    turns = Rotation.from_rotvec(clip.rotations.reshape(-1, 3))
    # At a gimbal lock the third angle is taken as 0, which is one of the right answers.
    angles = turns.as_euler("XYZ", degrees=True, suppress_warnings=True)
    return np.asarray(angles.reshape(clip.rotations.shape))


def _joint_errors(
    generated: FloatArray, recorded: FloatArray, setup: Setup
) -> Iterator[MetricResult]:
    if setup.spread is None or not setup.preset.joint_errors:
        return
    rate = min(setup.frame_rate, S2UE_FRAME_RATE)
    one, other = (
        _slower(select(points, TED_JOINTS), setup.frame_rate, rate)
        for points in (generated, recorded)
    )
    for settings in setup.preset.joint_errors:
        yield point_error(one, other, frame_rate=rate, settings=settings, scale=setup.spread.scale)


def _landmark_errors(
    clip: MeasuredClip, recorded: MeasuredClip, setup: Setup
) -> Iterator[MetricResult]:
    reason = clip.landmarks.reason or recorded.landmarks.reason
    scale = math.nan if setup.spread is None else setup.spread.face_scale
    if not reason and math.isnan(scale):
        reason = "no recording has a face that moves"
    none = np.zeros((1, 0, 3))
    one, other = (
        none if reason or side.landmarks.positions is None else side.landmarks.positions
        for side in (clip, recorded)
    )
    for settings in setup.preset.landmark_errors:
        result = point_error(
            one, other, frame_rate=setup.face_rate, settings=settings, scale=scale, missing=reason
        )
        yield replace(result, settings={**result.settings, **_ON_THE_FACE})


def _slower(points: FloatArray, frame_rate: float, wanted: float) -> FloatArray:
    """Return points at a lower frame rate, interpolated on straight lines."""
    if wanted == frame_rate:
        return points
    place = np.arange(max(1, round(len(points) * wanted / frame_rate))) * frame_rate / wanted
    place = np.minimum(place, len(points) - 1)
    before = place.astype(int)
    after = np.minimum(before + 1, len(points) - 1)
    share = (place - before)[:, None, None]
    return np.asarray((1 - share) * points[before] + share * points[after])
