"""All clips of one segment: recording and speech are looked at once for all conditions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analysis.metrics.absolute_error import S2UE_JOINTS
from analysis.metrics.clip_scores import MeasuredClip, clip_metrics
from analysis.metrics.joint_motion import JointMotionStore, joint_motion
from analysis.metrics.joint_positions import GESTURE_JOINTS, UPPER_BODY_JOINTS, select
from analysis.metrics.presets import Preset
from analysis.metrics.recorded_spread import ClipExtent, RecordedSpread
from analysis.metrics.result import MetricResult
from motion.audio import read_audio
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_clip, read_motion
from motion.formats.semantic_txt import SemanticSpan, read_semantic_scores
from motion.freeze import freeze
from motion.resample import resample
from motion.skeleton import joint_index
from motion.speech_onsets import speech_onsets

FloatArray = NDArray[np.float64]
Excerpt = tuple[Path, float, float]
"""A recording, and where in it an excerpt starts and ends, in seconds; infinity for its end."""


@dataclass(frozen=True, kw_only=True)
class Bench:
    """How all clips are measured; the same for all segments.

    Attributes
    ----------
    frame_rate : float
        Frames per second at which clips are compared.
    frozen : tuple of str
        Channels held still.
    preset : Preset
        Which metrics.
    spread : RecordedSpread or None
        Of all recordings, once it is known.
    store : JointMotionStore or None
        Where joint motions are kept between runs.
    own_files : bool
        Whether motion files are a study's own and read as they stand, as for its videos; files
        from elsewhere are put into the study's world.
    file_rate : float or None
        Frames per second of all motion files, in place of their own.
    """

    frame_rate: float
    frozen: tuple[str, ...]
    preset: Preset
    spread: RecordedSpread | None = None
    store: JointMotionStore | None = None
    own_files: bool = True
    file_rate: float | None = None


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


@dataclass(frozen=True, kw_only=True, eq=False)
class SegmentScores:
    """What was found out about one segment.

    Attributes
    ----------
    segment : str
        Its name.
    scores : tuple of ClipScore
        Every metric of every clip that could be read.
    upper_bodies : mapping of condition to ndarray, shape (T, 8, 3), float32
        Positions for distances between clips; empty where no preset asks for them.
    skipped : tuple of SkippedFile
        Files that could not be used.
    kept : tuple of Path
        What this segment uses of the store.
    """

    segment: str
    scores: tuple[ClipScore, ...] = ()
    upper_bodies: Mapping[str, NDArray[np.float32]] = field(default_factory=dict)
    skipped: tuple[SkippedFile, ...] = ()
    kept: tuple[Path, ...] = ()


def segment_scores(files: SegmentFiles, bench: Bench) -> SegmentScores:
    """Measure all clips of one segment; a file that cannot be used is named, never an error."""
    reader = _Reader(bench)
    onsets = _onsets(files.speech, reader) if bench.preset.beats and files.speech else None
    recorded = reader.clip(files.recorded) if files.recorded is not None else None
    semantics = _semantics(files.semantics, reader) if bench.preset.recalls else None
    scores: list[ClipScore] = []
    upper_bodies: dict[str, NDArray[np.float32]] = {}
    for condition, path in files.clips.items():
        clip = recorded if path == files.recorded else reader.clip(path)
        if clip is None:
            continue
        results = clip_metrics(
            clip,
            frame_rate=bench.frame_rate,
            preset=bench.preset,
            onsets=onsets,
            recorded=None if path == files.recorded else recorded,
            spread=bench.spread,
            semantics=semantics,
        )
        scores += [
            ClipScore(condition=condition, segment=files.segment, result=result)
            for result in results
        ]
        if bench.preset.pair_distance:
            upper = select(clip.joints.relative, UPPER_BODY_JOINTS)
            upper_bodies[condition] = upper.astype(np.float32)
    return SegmentScores(
        segment=files.segment,
        scores=tuple(scores),
        upper_bodies=upper_bodies,
        skipped=tuple(reader.skipped),
        kept=tuple(reader.kept),
    )


def recorded_extent(path: Path, bench: Bench) -> ClipExtent | None:
    """Return what one recording adds to the spread of all; None where it cannot be read."""
    reader = _Reader(bench)
    clip = reader.clip(path)
    if clip is None or clip.rotations is None:
        return None
    return ClipExtent.of(clip.rotations, select(clip.joints.relative, S2UE_JOINTS))


def _onsets(speech: Excerpt, reader: _Reader) -> FloatArray | None:
    recording, start, end = speech
    try:
        audio = read_audio(recording)
        excerpt = audio.cut(start, audio.duration if math.isinf(end) else end)
    except InputError as error:
        reader.skipped.append(SkippedFile.because(error))
        return None
    return speech_onsets(excerpt)


def _semantics(path: Path | None, reader: _Reader) -> tuple[SemanticSpan, ...] | None:
    if path is None:
        return None
    try:
        return read_semantic_scores(path)
    except InputError as error:
        reader.skipped.append(SkippedFile.because(error))
        return None


class _Reader:
    """Reads clips, and remembers which could not be read and what of the store was used."""

    def __init__(self, bench: Bench) -> None:
        self._bench = bench
        self.skipped: list[SkippedFile] = []
        self.kept: list[Path] = []

    def clip(self, path: Path) -> MeasuredClip | None:
        """Return what metrics look at in the motion file `path`; None where it is unusable."""
        try:
            return self._measured(path)
        except InputError as error:
            self.skipped.append(SkippedFile.because(error))
            return None

    def _measured(self, path: Path) -> MeasuredClip:
        bench = self._bench
        place = self._place(path)
        joints = bench.store.read(place) if bench.store and place else None
        if joints is not None and not bench.preset.needs_rotations:
            return MeasuredClip(joints=joints)
        read = read_clip if bench.own_files else read_motion
        clip = read(path, frame_rate=bench.file_rate)
        if joints is None:
            joints = joint_motion(clip, bench.frame_rate, bench.frozen)
            if bench.store and place:
                bench.store.keep(place, joints)
        rotations = _rotations(clip, bench) if bench.preset.needs_rotations else None
        return MeasuredClip(joints=joints, rotations=rotations)

    def _place(self, path: Path) -> Path | None:
        """Return where the store keeps the clip's joint motion, if there is a store."""
        bench = self._bench
        if bench.store is None:
            return None
        place = bench.store.place(path, bench.frame_rate, bench.frozen, bench.file_rate)
        self.kept.append(place)
        return place


def _rotations(clip: MotionClip, bench: Bench) -> FloatArray:
    seen = freeze(resample(clip, bench.frame_rate), bench.frozen)
    return seen.poses[:, [joint_index(name) for name in GESTURE_JOINTS]].astype(np.float64)
