"""All clips of one segment: recording and speech are looked at once for all conditions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analysis.measurement.clip_scores import clip_metrics
from analysis.measurement.measured_clips import Bench, MeasuredClip, Reader, SkippedFile
from analysis.measurement.recorded_spread import ClipExtent
from analysis.metrics.joint_positions import UPPER_BODY_JOINTS, select
from analysis.metrics.result import MetricResult
from analysis.metrics.speed_histogram import Counts, speed_counts
from motion.errors import InputError
from motion.formats.semantic_txt import SemanticSpan, read_semantic_scores
from motion.formats.ted_npz import JOINT_NAMES as TED_JOINTS

FloatArray = NDArray[np.float64]
Excerpt = tuple[Path, float, float]
"""A recording, and where in it an excerpt starts and ends, in seconds; infinity for its end."""


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
        Which of the recording's gestures carry meaning (`motion.formats.semantic_txt`).
    """

    segment: str
    clips: Mapping[str, Path]
    recorded: Path | None = None
    speech: Excerpt | None = None
    semantics: Path | None = None


@dataclass(frozen=True, kw_only=True)
class ClipScore:
    """One metric of one clip."""

    condition: str
    segment: str
    result: MetricResult


@dataclass(frozen=True, kw_only=True, eq=False)
class SegmentScores:
    """What was found out about one segment.

    Attributes
    ----------
    segment : str
        Its name.
    readable : tuple of str
        Conditions whose clip could be read.
    scores : tuple of ClipScore
        Every metric of every clip that could be read.
    upper_bodies : mapping of condition to ndarray, shape (T, 8, 3), float32
        Positions for distances between clips; empty where no preset asks for them.
    faces : mapping of condition to ndarray, shape (T, 52) or (T, 100), float32
        Faces for distances between clips; empty where no preset asks for them, and for clips
        without a face.
    speeds : mapping of condition to ndarray, shape (8, 80), int
        How often each speed occurs (`analysis.metrics.speed_histogram`); empty where no preset
        asks for it.
    recorded_speeds : ndarray, shape (8, 80), int, or None
        The same of the recording.
    skipped : tuple of SkippedFile
        Files that could not be used.
    kept : tuple of Path
        What this segment uses of the store.
    """

    segment: str
    readable: tuple[str, ...] = ()
    scores: tuple[ClipScore, ...] = ()
    upper_bodies: Mapping[str, NDArray[np.float32]] = field(default_factory=dict)
    faces: Mapping[str, NDArray[np.float32]] = field(default_factory=dict)
    speeds: Mapping[str, Counts] = field(default_factory=dict)
    recorded_speeds: Counts | None = None
    skipped: tuple[SkippedFile, ...] = ()
    kept: tuple[Path, ...] = ()


def segment_scores(files: SegmentFiles, bench: Bench) -> SegmentScores:
    """Measure all clips of one segment; a file that cannot be used is named, never an error."""
    reader = Reader(bench)
    onsets = _onsets(files.speech, reader) if bench.preset.beats and files.speech else None
    recorded = reader.clip(files.recorded) if files.recorded is not None else None
    semantics = _semantics(files.semantics, reader) if bench.preset.correct else None
    readable: list[str] = []
    scores: list[ClipScore] = []
    upper_bodies: dict[str, NDArray[np.float32]] = {}
    faces: dict[str, NDArray[np.float32]] = {}
    speeds: dict[str, Counts] = {}
    for condition, path in files.clips.items():
        clip = recorded if path == files.recorded else reader.clip(path)
        if clip is None:
            continue
        readable.append(condition)
        results = clip_metrics(
            clip,
            bench,
            onsets=onsets,
            recorded=None if path == files.recorded else recorded,
            semantics=semantics,
        )
        scores += [
            ClipScore(condition=condition, segment=files.segment, result=result)
            for result in results
        ]
        if bench.preset.pair_distance:
            upper = select(clip.joints.relative, UPPER_BODY_JOINTS)
            upper_bodies[condition] = upper.astype(np.float32)
        if bench.preset.speed_histogram:
            speeds[condition] = _speeds(clip, bench)
        if clip.face is not None:
            faces[condition] = clip.face
    return SegmentScores(
        segment=files.segment,
        readable=tuple(readable),
        scores=tuple(scores),
        upper_bodies=upper_bodies,
        faces=faces,
        speeds=speeds,
        recorded_speeds=_speeds(recorded, bench)
        if recorded is not None and bench.preset.speed_histogram
        else None,
        skipped=tuple(reader.skipped),
        kept=tuple(reader.kept),
    )


def recorded_extent(path: Path, bench: Bench) -> ClipExtent | None:
    """Return what one recording adds to the spread of all; None where it cannot be read."""
    reader = Reader(bench)
    clip = reader.clip(path)
    if clip is None or clip.rotations is None:
        return None
    return ClipExtent.of(
        clip.rotations, select(clip.joints.relative, TED_JOINTS), clip.landmarks.positions
    )


def _speeds(clip: MeasuredClip, bench: Bench) -> Counts:
    return speed_counts(select(clip.joints.relative, UPPER_BODY_JOINTS), bench.frame_rate)


def _onsets(speech: Excerpt, reader: Reader) -> FloatArray | None:
    try:
        return reader.onsets(*speech)
    except InputError as error:
        reader.skipped.append(SkippedFile.because(error))
        return None


def _semantics(path: Path | None, reader: Reader) -> tuple[SemanticSpan, ...] | None:
    if path is None:
        return None
    try:
        return read_semantic_scores(path)
    except InputError as error:
        reader.skipped.append(SkippedFile.because(error))
        return None
