"""All metrics of the clips of one segment; its recording and speech are read once."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from analysis.evaluators.feature_networks import ClipFeatures
from analysis.measurement.measured_clips import (
    Excerpt,
    MeasuredClip,
    Onsets,
    Reader,
    Setup,
)
from analysis.measurement.recorded_spread import ClipExtent, RecordedSpread
from analysis.metrics.beat_alignment import beat_alignment
from analysis.metrics.correct_motion import CorrectSettings, correct_share
from analysis.metrics.diversity import l1_deviation
from analysis.metrics.kinematics import (
    ARM_JOINTS,
    FEET,
    GESTURE_JOINTS,
    UPPER_BODY_JOINTS,
    foot_sliding,
    mean_derivative,
    select,
)
from analysis.metrics.point_errors import S2UE_FRAME_RATE, point_error, velocity_error
from analysis.metrics.scores import MetricResult
from analysis.metrics.self_penetration import self_penetration
from motion.arrays import Floats, Floats32
from motion.audio_analysis import DETECTOR
from motion.errors import InputError
from motion.files import sha256_of
from motion.formats.beat_tracks import SemanticSpan, read_semantic_scores, semantic_weights
from motion.formats.ted_npz import JOINT_NAMES as TED_JOINTS
from motion.resample import frame_positions

_FACE_SETTINGS: Final = {
    "positions": "on the mean shape of one body, the head held still",
    "box": "that of the recordings' landmarks",
}


@dataclass(frozen=True, kw_only=True)
class SegmentFiles:
    """The files of one segment.

    Attributes
    ----------
    segment : str
        The segment's name.
    clips : mapping of condition to path
        Motion files.
    recorded : Path or None
        Recorded motion of the same speech.
    speech : Excerpt or None
        The speech.
    semantics : Path or None
        The recording's gestures that carry meaning (`motion.formats.beat_tracks`).
    """

    segment: str
    clips: Mapping[str, Path]
    recorded: Path | None = None
    speech: Excerpt | None = None
    semantics: Path | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class ClipMeasurements:
    """The measurements of one clip.

    Attributes
    ----------
    scores : tuple of MetricResult
        All metrics of the clip, on its own and compared with its recording.
    upper_body : ndarray, shape (T, 8, 3), float32, or None
        Positions for distances between clips, if a preset requests them.
    face : ndarray, shape (T, 52) or (T, 100), float32, or None
        The face for distances between clips, if a preset requests them and the clip has one.
    features : mapping of str to ClipFeatures
        The features of each network, by its name.
    """

    scores: tuple[MetricResult, ...] = ()
    upper_body: Floats32 | None = None
    face: Floats32 | None = None
    features: Mapping[str, ClipFeatures] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True, eq=False)
class SegmentScores:
    """The measurements of one segment.

    Attributes
    ----------
    segment : str
        The segment's name.
    clips : mapping of condition to ClipMeasurements
        Every clip that could be read.
    recorded : ClipMeasurements or None
        The recording, without scores.
    skipped : tuple of InputError
        About files that could not be used.
    notes : tuple of str
        On files that were read.
    """

    segment: str
    clips: Mapping[str, ClipMeasurements]
    recorded: ClipMeasurements | None
    skipped: tuple[InputError, ...]
    notes: tuple[str, ...]


def segment_scores(files: SegmentFiles, setup: Setup) -> SegmentScores:
    """Measure all clips of one segment; unusable files are listed instead of raising an error."""
    reader, preset = Reader(setup), setup.preset
    onsets = recorded = semantics = None
    if preset.beats and files.speech:
        onsets = reader.read_or_skip(reader.onsets, files.speech)
    if files.recorded is not None:
        recorded = reader.read_or_skip(reader.clip, files.recorded)
    if preset.correct and files.semantics is not None:
        semantics = reader.read_or_skip(read_semantic_scores, files.semantics)
    clips = {}
    for condition, path in files.clips.items():
        is_recorded = path == files.recorded
        clip = recorded if is_recorded else reader.read_or_skip(reader.clip, path)
        if clip is not None:
            scores = _clip_metrics(
                clip,
                setup,
                onsets=onsets,
                recorded=None if is_recorded else recorded,
                semantics=semantics,
            )
            clips[condition] = _measurements(clip, setup, tuple(scores))
    return SegmentScores(
        segment=files.segment,
        clips=clips,
        recorded=None if recorded is None else _measurements(recorded, setup),
        skipped=tuple(reader.skipped),
        notes=tuple(reader.notes),
    )


def _measurements(
    clip: MeasuredClip, setup: Setup, scores: tuple[MetricResult, ...] = ()
) -> ClipMeasurements:
    upper = select(clip.joints.relative, UPPER_BODY_JOINTS)
    return ClipMeasurements(
        scores=scores,
        upper_body=upper.astype(np.float32) if setup.preset.pair_distance else None,
        face=clip.face,
        features=clip.features,
    )


def recorded_extent(path: Path, setup: Setup) -> ClipExtent | None:
    """Return one recording's contribution to the spread of all; None if it cannot be read."""
    reader = Reader(setup)
    clip = reader.read_or_skip(reader.clip, path)
    if clip is None or clip.rotations is None:
        return None
    return ClipExtent.of(
        clip.rotations, select(clip.joints.relative, TED_JOINTS), clip.landmarks.positions
    )


def _clip_metrics(
    clip: MeasuredClip,
    setup: Setup,
    *,
    onsets: Onsets | None = None,
    recorded: MeasuredClip | None = None,
    semantics: tuple[SemanticSpan, ...] | None = None,
) -> Iterator[MetricResult]:
    """Yield every metric of the preset for which there is data.

    Parameters
    ----------
    clip : MeasuredClip
        The clip that is measured.
    setup : Setup
        The settings; without the recordings' spread nothing is normalised by it.
    onsets : Onsets or None
        Onsets of the speech; None for no beat alignment.
    recorded : MeasuredClip or None
        The recording of the same speech; None for no errors.
    semantics : tuple of SemanticSpan or None
        The gestures that carry meaning; None for no semantic recall.
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
    if setup.penetrable is not None and clip.depths is not None and len(clip.depths):
        body = f"{setup.penetrable.stem}, file {sha256_of(setup.penetrable)[:16]}"
        yield from self_penetration(clip.depths, body=body)


def pose_settings(frame_rate: float) -> dict[str, str]:
    """Return the settings of upper-body positions in words."""
    return {
        "joints": ", ".join(UPPER_BODY_JOINTS),
        "frame rate": f"{frame_rate:g} fps",
        "positions": "relative to the pelvis, default body, metres",
    }


def _beats(positions: Floats, onsets: Onsets, setup: Setup) -> Iterator[MetricResult]:
    for settings in setup.preset.beats:
        yield from beat_alignment(
            select(positions, ARM_JOINTS),
            onsets.times,
            speech_duration=onsets.speech_duration,
            frame_rate=setup.frame_rate,
            settings=settings,
            detector=DETECTOR,
        )


def _correct(
    clip: MeasuredClip,
    recorded: MeasuredClip,
    setup: Setup,
    semantics: tuple[SemanticSpan, ...] | None,
) -> Iterator[MetricResult]:
    for settings in setup.preset.correct:
        generated, reference = (
            _represented(side, settings, setup.spread) for side in (clip, recorded)
        )
        if generated is None or reference is None:
            continue
        results = [correct_share(generated, reference, settings=settings)]
        if semantics is not None:
            frames = max(len(generated), len(reference))
            weights = semantic_weights(semantics, frames, setup.frame_rate)
            results.append(correct_share(generated, reference, weights, settings=settings))
        is_rotation = settings.representation != "positions"
        measured = {
            "joints": ", ".join(GESTURE_JOINTS if is_rotation else UPPER_BODY_JOINTS),
            "frame rate": f"{setup.frame_rate:g} fps",
        }
        for result in results:
            yield replace(result, settings={**result.settings, **measured})


def _represented(
    clip: MeasuredClip, settings: CorrectSettings, spread: RecordedSpread | None
) -> Floats | None:
    """Return the motion in the representation of `settings`; None if it is unknown."""
    if settings.representation == "positions":
        return select(clip.joints.relative, UPPER_BODY_JOINTS)
    if clip.rotations is None:
        return None
    if settings.representation == "normalised rotations":
        return None if spread is None else spread.normalised(clip.rotations)
    rotations = Rotation.from_rotvec(clip.rotations.reshape(-1, 3))
    # In gimbal lock the third angle is set to 0, which is one of the valid solutions.
    angles = rotations.as_euler("XYZ", degrees=True, suppress_warnings=True)
    return np.asarray(angles.reshape(clip.rotations.shape))


def _joint_errors(generated: Floats, recorded: Floats, setup: Setup) -> Iterator[MetricResult]:
    if setup.spread is None or not setup.preset.joint_errors:
        return
    rate = min(setup.frame_rate, S2UE_FRAME_RATE)
    generated, recorded = (
        _at_lower_rate(select(points, TED_JOINTS), setup.frame_rate, rate)
        for points in (generated, recorded)
    )
    for settings in setup.preset.joint_errors:
        yield point_error(
            generated, recorded, frame_rate=rate, settings=settings, scale=setup.spread.scale
        )


def _landmark_errors(
    clip: MeasuredClip, recorded: MeasuredClip, setup: Setup
) -> Iterator[MetricResult]:
    generated, reference = clip.landmarks.positions, recorded.landmarks.positions
    scale = math.nan if setup.spread is None else setup.spread.face_scale
    reason = clip.landmarks.reason
    if recorded.landmarks.reason and not reason:
        reason = f"the recording has no landmarks: {recorded.landmarks.reason}"
    reason = reason or ("no recording has a face that moves" if math.isnan(scale) else "")
    for settings in setup.preset.landmark_errors:
        if reason or generated is None or reference is None:
            description = settings.description(setup.face_rate, scale)
            result = settings.metric.missing(reason, description)
        else:
            result = point_error(
                generated, reference, frame_rate=setup.face_rate, settings=settings, scale=scale
            )
        yield replace(result, settings={**result.settings, **_FACE_SETTINGS})


def _at_lower_rate(points: Floats, frame_rate: float, lower: float) -> Floats:
    """Return points at a lower frame rate, linearly interpolated."""
    before, after, share = frame_positions(len(points), frame_rate, lower)
    weight = share[:, None, None]
    return np.asarray((1 - weight) * points[before] + weight * points[after])
