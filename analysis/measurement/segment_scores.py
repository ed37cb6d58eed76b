"""All clips of one segment: recording and speech are looked at once for all conditions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analysis.evaluators.feature_networks import ClipFeatures
from analysis.measurement.clip_scores import clip_metrics
from analysis.measurement.measured_clips import Excerpt, MeasuredClip, Reader, Setup
from analysis.measurement.recorded_spread import ClipExtent
from analysis.measurement.scores import SkippedFile
from analysis.metrics.joint_motion import UPPER_BODY_JOINTS, select
from analysis.metrics.kinematics import Counts, speed_counts
from analysis.metrics.result import MetricResult
from motion.formats.beat_tracks import read_semantic_scores
from motion.formats.ted_npz import JOINT_NAMES as TED_JOINTS

Array = NDArray[np.float32]


@dataclass(frozen=True, kw_only=True)
class SegmentFiles:
    """What there is of one segment.

    Attributes
    ----------
    segment : str
        Its name.
    clips : mapping of condition to path
        Motion files.
    recorded : Path or None
        The recorded motion of the same speech.
    speech : Excerpt or None
        What is said.
    semantics : Path or None
        Which of the recording's gestures carry meaning (`motion.formats.beat_tracks`).
    """

    segment: str
    clips: Mapping[str, Path]
    recorded: Path | None = None
    speech: Excerpt | None = None
    semantics: Path | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class ClipFindings:
    """What was found out about one clip that could be read.

    Attributes
    ----------
    scores : tuple of MetricResult
        Every metric of the clip alone, or beside its recording.
    upper_body : ndarray, shape (T, 8, 3), float32, or None
        Positions for distances between clips, where a preset asks for them.
    face : ndarray, shape (T, 52) or (T, 100), float32, or None
        The face for distances between clips, where a preset asks for them and the clip has one.
    speeds : ndarray, shape (8, 80), int, or None
        How often each speed occurs (`analysis.metrics.kinematics`), where that is asked for.
    features : mapping of str to ClipFeatures
        What each network says, by its name.
    depths : ndarray, shape (n,), float32, or None
        How deep the arms are in the body, where that is asked for.
    """

    scores: tuple[MetricResult, ...] = ()
    upper_body: Array | None = None
    face: Array | None = None
    speeds: Counts | None = None
    features: Mapping[str, ClipFeatures] = field(default_factory=dict)
    depths: Array | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class SegmentScores:
    """What was found out about one segment.

    Attributes
    ----------
    segment : str
        Its name.
    clips : mapping of condition to ClipFindings
        Every clip that could be read.
    recorded : ClipFindings or None
        The same of the recording, without scores.
    skipped : tuple of SkippedFile
        Files that could not be used.
    kept : frozenset of Path
        What this segment uses of the arrays that are kept between runs.
    """

    segment: str
    clips: Mapping[str, ClipFindings]
    recorded: ClipFindings | None
    skipped: tuple[SkippedFile, ...]
    kept: frozenset[Path]


def segment_scores(files: SegmentFiles, setup: Setup) -> SegmentScores:
    """Measure all clips of one segment; a file that cannot be used is named, never an error."""
    reader, preset = Reader(setup), setup.preset
    onsets = reader.onsets(files.speech) if preset.beats and files.speech else None
    recorded = reader.clip(files.recorded) if files.recorded is not None else None
    semantics = None
    if preset.correct and files.semantics is not None:
        semantics = reader.or_skipped(read_semantic_scores, files.semantics)
    clips = {}
    for condition, path in files.clips.items():
        is_recorded = path == files.recorded
        clip = recorded if is_recorded else reader.clip(path)
        if clip is not None:
            beside = None if is_recorded else recorded
            scores = clip_metrics(clip, setup, onsets=onsets, recorded=beside, semantics=semantics)
            clips[condition] = _findings(clip, setup, tuple(scores))
    return SegmentScores(
        segment=files.segment,
        clips=clips,
        recorded=None if recorded is None else _findings(recorded, setup),
        skipped=tuple(reader.skipped),
        kept=frozenset(reader.kept.used),
    )


def _findings(
    clip: MeasuredClip, setup: Setup, scores: tuple[MetricResult, ...] = ()
) -> ClipFindings:
    upper = select(clip.joints.relative, UPPER_BODY_JOINTS)
    preset = setup.preset
    return ClipFindings(
        scores=scores,
        upper_body=upper.astype(np.float32) if preset.pair_distance else None,
        face=clip.face,
        speeds=speed_counts(upper, setup.frame_rate) if preset.speed_histogram else None,
        features=clip.features,
        depths=clip.depths,
    )


def recorded_extent(path: Path, setup: Setup) -> ClipExtent | None:
    """Return what one recording adds to the spread of all; None where it cannot be read."""
    clip = Reader(setup).clip(path)
    if clip is None or clip.rotations is None:
        return None
    return ClipExtent.of(
        clip.rotations, select(clip.joints.relative, TED_JOINTS), clip.landmarks.positions
    )
