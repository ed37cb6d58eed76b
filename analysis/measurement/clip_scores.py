"""All metrics of one clip."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from analysis.measurement.measured_clips import FACE_RATE, Landmarks, MeasuredClip
from analysis.measurement.presets import Preset
from analysis.measurement.recorded_spread import RecordedSpread
from analysis.metrics.absolute_error import S2UE_FRAME_RATE, absolute_error
from analysis.metrics.acceleration import acceleration
from analysis.metrics.acceleration_error import acceleration_error
from analysis.metrics.beat_alignment import beat_alignment
from analysis.metrics.correct_motion import CorrectSettings, percent_correct_motion
from analysis.metrics.diversity import l1_deviation
from analysis.metrics.foot_sliding import FEET, foot_sliding
from analysis.metrics.jerk import jerk
from analysis.metrics.joint_positions import GESTURE_JOINTS, UPPER_BODY_JOINTS, select
from analysis.metrics.result import MetricResult
from analysis.metrics.semantic_recall import semantic_recall
from analysis.metrics.velocity_error import velocity_error
from motion.formats.semantic_txt import SemanticSpan, semantic_weights
from motion.formats.ted_npz import JOINT_NAMES as TED_JOINTS
from motion.speech_onsets import DETECTOR

FloatArray = NDArray[np.float64]

_ON_THE_FACE: Final = {
    "positions": "on the mean shape of one body, the head held still",
    "box": "that of the recordings' landmarks",
}


def clip_metrics(
    clip: MeasuredClip,
    *,
    frame_rate: float,
    preset: Preset,
    onsets: FloatArray | None = None,
    recorded: MeasuredClip | None = None,
    spread: RecordedSpread | None = None,
    semantics: tuple[SemanticSpan, ...] | None = None,
) -> Iterator[MetricResult]:
    """Yield every metric of `preset` that the given material allows.

    Parameters
    ----------
    clip : MeasuredClip
        The clip that is measured.
    frame_rate : float
        Frames per second of both clips.
    preset : Preset
        Which metrics, and how.
    onsets : ndarray or None
        Onsets of the speech in seconds; without them there is no beat alignment.
    recorded : MeasuredClip or None
        The recording of the same speech; without it there are no errors.
    spread : RecordedSpread or None
        Of all recordings; without it there is nothing that is normalised by them.
    semantics : tuple of SemanticSpan or None
        Which gestures carry meaning; without them there is no semantic recall.
    """
    positions = clip.joints.relative
    if onsets is not None:
        yield from _beats(positions, onsets, frame_rate, preset)
    for settings in preset.jerks:
        measured = select(positions, settings.joints)
        yield jerk(measured, frame_rate=frame_rate, settings=settings)
    if preset.acceleration:
        yield acceleration(select(positions, UPPER_BODY_JOINTS), frame_rate=frame_rate)
    if preset.mean_pose_deviation:
        yield l1_deviation(select(positions, UPPER_BODY_JOINTS), settings=pose_settings(frame_rate))
    if preset.foot_sliding:
        world = positions + clip.joints.pelvis[:, None]
        yield foot_sliding(select(world, FEET), frame_rate=frame_rate)
    if recorded is not None:
        yield from _correct(clip, recorded, frame_rate, preset, spread, semantics)
        yield from _velocity_errors(positions, recorded.joints.relative, frame_rate, preset)
        if spread is not None:
            yield from _point_errors(
                positions, recorded.joints.relative, frame_rate, preset, spread
            )
        if preset.needs_landmarks:
            yield from _landmark_errors(
                clip.landmarks, recorded.landmarks, min(frame_rate, FACE_RATE), preset, spread
            )


def pose_settings(frame_rate: float) -> dict[str, str]:
    """Return what positions of the upper body are, in words."""
    return {
        "joints": ", ".join(UPPER_BODY_JOINTS),
        "frame rate": f"{frame_rate:g} fps",
        "positions": "relative to the pelvis, default body, metres",
    }


def _beats(
    positions: FloatArray, onsets: FloatArray, frame_rate: float, preset: Preset
) -> Iterator[MetricResult]:
    for settings in preset.beats:
        found = beat_alignment(
            select(positions, settings.joints),
            onsets,
            frame_rate=frame_rate,
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
    frame_rate: float,
    preset: Preset,
    spread: RecordedSpread | None,
    semantics: tuple[SemanticSpan, ...] | None,
) -> Iterator[MetricResult]:
    for settings in dict.fromkeys((*preset.correct, *preset.recalls)):
        both = [_represented(one, settings, spread) for one in (clip, recorded)]
        if both[0] is None or both[1] is None:
            continue
        found = []
        if settings in preset.correct:
            found.append(percent_correct_motion(both[0], both[1], settings=settings))
        if settings in preset.recalls and semantics is not None:
            frames = max(map(len, (both[0], both[1])))
            weights = semantic_weights(semantics, frames, frame_rate)
            found.append(semantic_recall(both[0], both[1], weights, settings=settings))
        joints: tuple[str, ...] = UPPER_BODY_JOINTS
        if settings.representation != "positions":
            joints = GESTURE_JOINTS
        measured = {"joints": ", ".join(joints), "frame rate": f"{frame_rate:g} fps"}
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


def _velocity_errors(
    positions: FloatArray, recorded: FloatArray, frame_rate: float, preset: Preset
) -> Iterator[MetricResult]:
    for norm in preset.velocity_errors:
        yield velocity_error(
            select(positions, UPPER_BODY_JOINTS),
            select(recorded, UPPER_BODY_JOINTS),
            frame_rate=frame_rate,
            norm=norm,
            settings=pose_settings(frame_rate),
        )


def _point_errors(
    positions: FloatArray,
    recorded: FloatArray,
    frame_rate: float,
    preset: Preset,
    spread: RecordedSpread,
) -> Iterator[MetricResult]:
    if not (preset.absolute_errors or preset.acceleration_errors):
        return
    rate = min(frame_rate, S2UE_FRAME_RATE)
    generated, other = (
        _slower(select(points, TED_JOINTS), frame_rate, rate) for points in (positions, recorded)
    )
    for settings in preset.absolute_errors:
        yield absolute_error(
            generated, other, frame_rate=rate, settings=settings, scale=spread.scale
        )
    for settings in preset.acceleration_errors:
        yield acceleration_error(
            generated, other, frame_rate=rate, settings=settings, scale=spread.scale
        )


def _landmark_errors(
    generated: Landmarks,
    recorded: Landmarks,
    frame_rate: float,
    preset: Preset,
    spread: RecordedSpread | None,
) -> Iterator[MetricResult]:
    reason = generated.reason or recorded.reason
    scale = math.nan if spread is None else spread.face_scale
    if not reason and math.isnan(scale):
        reason = "no recording has a face that moves"
    none = np.zeros((1, 0, 3))
    one, other = (
        none if reason or side.positions is None else side.positions
        for side in (generated, recorded)
    )
    for settings in preset.landmark_errors:
        result = absolute_error(
            one, other, frame_rate=frame_rate, settings=settings, scale=scale, missing=reason
        )
        yield replace(result, settings={**result.settings, **_ON_THE_FACE})
    for settings in preset.landmark_accelerations:
        result = acceleration_error(
            one, other, frame_rate=frame_rate, settings=settings, scale=scale, missing=reason
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
