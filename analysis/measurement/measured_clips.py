"""Reading motion files, and the data of a clip from which metrics are computed."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Final, NamedTuple, TypeVar

import numpy as np

from analysis.evaluators.feature_networks import ClipFeatures, Network, clip_features
from analysis.measurement.kept_arrays import kept_array
from analysis.measurement.presets import Preset
from analysis.measurement.recorded_spread import RecordedSpread
from analysis.metrics.kinematics import GESTURE_JOINTS, JointMotion, packed_joints
from analysis.metrics.self_penetration import PenetrableBody
from motion.arrays import Floats, Floats32
from motion.audio import read_audio
from motion.audio_analysis import speech_onsets
from motion.body.face_landmarks import FaceLandmarks
from motion.body.model import read_body
from motion.clip import MotionClip, freeze
from motion.errors import InputError
from motion.formats import read_clip, read_recorded
from motion.formats.beat_tracks import face_beside
from motion.resample import resample
from motion.skeleton import joint_index

Excerpt = tuple[Path, float, float]
"""A recording, and the start and end of an excerpt in seconds; infinity for its end."""

_Source = TypeVar("_Source")
_Data = TypeVar("_Data")

JOINTS: Final = "joints-1"
FEATURES: Final = "features-1"
ONSETS: Final = "onsets-2"
LANDMARKS: Final = "landmarks-1"
DEPTHS: Final = "depths-1"

FACE_RATE: Final = 15.0
"""Frames per second of faces and their landmarks; S2UE's and DiffSHEG's."""


@dataclass(frozen=True, kw_only=True)
class LandmarkBody:
    """The body of the face landmarks.

    Attributes
    ----------
    path : Path
        The body's file.
    expression_matrix : Path or None
        As in `motion.body.model.read_body`.
    """

    path: Path
    expression_matrix: Path | None = None


@dataclass(frozen=True, kw_only=True)
class SeenMotion:
    """How the motion files of a run are read.

    Attributes
    ----------
    frozen : tuple of str
        Channels that the study keeps still.
    own_files : bool
        Whether files are a study's own and read as they are; other files may have any format and
        are brought into the study's world.
    file_rate : float or None
        Frames per second of all files, in place of the stated rate.
    """

    frozen: tuple[str, ...] = ()
    own_files: bool = True
    file_rate: float | None = None

    def files(self, path: Path) -> tuple[Path, ...]:
        """Return the files of the clip in `path`: its own, and a face next to it."""
        face = face_beside(path)
        return (path,) if self.own_files or not face.is_file() else (path, face)

    def read(self, path: Path) -> tuple[MotionClip, list[str]]:
        """Return the clip in `path`, with its frozen channels still, and notes for the researcher.

        Raises
        ------
        InputError
            If the file cannot be used.
        """
        notes: list[str] = []
        if self.own_files:
            clip = read_clip(path, frame_rate=self.file_rate)
        else:
            clip, notes = read_recorded(path, frame_rate=self.file_rate)
        return freeze(clip, self.frozen), notes

    def __str__(self) -> str:
        """Return a text that differs if clips may be read differently."""
        return f"{sorted(self.frozen)} {self.own_files} {self.file_rate!r}"


@dataclass(frozen=True, kw_only=True)
class Setup:
    """How the clips of a run are measured.

    Attributes
    ----------
    frame_rate : float
        Frames per second at which clips are compared.
    motion : SeenMotion
        How motion files are read.
    preset : Preset
        The metrics.
    spread : RecordedSpread or None
        Spread of all recordings; None until known.
    kept : Path or None
        Folder that keeps arrays between runs.
    face : LandmarkBody or None
        The body of the face landmarks; None for no landmarks.
    networks : tuple of Network
        The feature networks.
    penetrable : Path or None
        The body for self-penetration.
    """

    frame_rate: float
    motion: SeenMotion
    preset: Preset
    spread: RecordedSpread | None = None
    kept: Path | None = None
    face: LandmarkBody | None = None
    networks: tuple[Network, ...] = ()
    penetrable: Path | None = None

    @property
    def face_rate(self) -> float:
        """Frames per second of faces."""
        return min(self.frame_rate, FACE_RATE)


@dataclass(frozen=True, kw_only=True, eq=False)
class Landmarks:
    """Landmarks of a clip's face.

    Attributes
    ----------
    positions : ndarray, shape (T, L, 3), or None
        In metres, with the head held still; None with a `reason`, or if not requested.
    reason : str
        Why there are no landmarks.
    """

    positions: Floats | None = None
    reason: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredClip:
    """The data of one clip from which metrics are computed.

    Attributes
    ----------
    joints : JointMotion
        Joint positions.
    rotations : ndarray, shape (T, G, 3), or None
        Axis-angle of `analysis.metrics.kinematics.GESTURE_JOINTS`, if a preset needs them.
    landmarks : Landmarks
        At `Setup.face_rate`.
    face : ndarray, shape (U, 52) or (U, 100), float32, or None
        ARKit weights, else SMPL-X coefficients, at `Setup.face_rate`; None if the clip has
        neither or no preset needs them.
    features : mapping of str to ClipFeatures
        The features of each network, by its name.
    depths : ndarray, shape (n,), float32, or None
        Depth of the arms inside the body, in metres, if requested.
    """

    joints: JointMotion
    rotations: Floats | None = None
    landmarks: Landmarks = field(default_factory=Landmarks)
    face: Floats32 | None = None
    features: Mapping[str, ClipFeatures] = field(default_factory=dict)
    depths: Floats32 | None = None


class Onsets(NamedTuple):
    """The onsets of an excerpt of speech, and its length, in seconds."""

    times: Floats
    speech_duration: float


class Reader:
    """Reads the files of a run and lists those that cannot be used.

    Attributes
    ----------
    skipped : list of InputError
        About files that could not be used.
    notes : list of str
        On files that were read.
    """

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        self._last: tuple[Path, MotionClip] | None = None
        self.skipped: list[InputError] = []
        self.notes: list[str] = []

    def read_or_skip(self, read: Callable[[_Source], _Data], source: _Source) -> _Data | None:
        """Return what `read` reads; if it cannot, list the file as skipped and return None."""
        try:
            return read(source)
        except InputError as error:
            self.skipped.append(error)
            return None

    def onsets(self, speech: Excerpt) -> Onsets:
        """Return the onsets of an excerpt; raise `InputError` if it is unusable."""
        recording, start, end = speech

        def compute() -> Floats32:
            audio = read_audio(recording)
            excerpt = audio.cut(start, audio.duration if math.isinf(end) else end)
            return np.append(speech_onsets(excerpt), excerpt.duration).astype(np.float32)

        excerpt = f"{start!r} {end!r}"
        *times, duration = kept_array(self._setup.kept, ONSETS, (recording,), excerpt, compute)
        return Onsets(np.array(times, np.float64), float(duration))

    def clip(self, path: Path) -> MeasuredClip:
        """Return the data of a motion file; raise `InputError` if it is unusable."""
        setup, preset = self._setup, self._setup.preset
        rate, motion = setup.frame_rate, setup.motion
        joints = self._kept(JOINTS, path, f"{rate!r} {motion}", lambda c: packed_joints(c, rate))
        rotations = face = depths = None
        landmarks = Landmarks()
        if preset.needs_rotations:
            poses = resample(self._read(path), rate).poses
            rotations = poses[:, [joint_index(name) for name in GESTURE_JOINTS]]
        if preset.landmark_errors:
            landmarks = self._landmarks(path)
        if preset.expression_distance:
            clip = resample(self._read(path), setup.face_rate)
            face = clip.arkit if clip.arkit is not None else clip.expressions
        features = {network.name: self._features(network, path) for network in setup.networks}
        if setup.penetrable is not None:
            body = setup.penetrable
            depths = self._kept(
                DEPTHS, path, f"{motion}", lambda clip: penetrable_body(body).depths(clip), body
            )
        return MeasuredClip(
            joints=JointMotion.of(joints),
            rotations=None if rotations is None else rotations.astype(np.float64),
            landmarks=landmarks,
            face=face,
            features=features,
            depths=depths,
        )

    def _read(self, path: Path) -> MotionClip:
        """Return the clip in `path`, read once for consecutive uses."""
        if self._last is None or self._last[0] != path:
            clip, notes = self._setup.motion.read(path)
            self._last = path, clip
            # Generated and recorded files have the same names.
            self.notes += (f"{path.absolute().parent.name}: {note}" for note in notes)
        return self._last[1]

    def _kept(
        self,
        kind: str,
        path: Path,
        settings: str,
        compute: Callable[[MotionClip], Floats32],
        *others: Path,
    ) -> Floats32:
        files = (*self._setup.motion.files(path), *others)
        return kept_array(
            self._setup.kept, kind, files, settings, lambda: compute(self._read(path))
        )

    def _features(self, network: Network, path: Path) -> ClipFeatures:
        motion = self._setup.motion
        settings = f"{network.sha256} {motion}"
        return clip_features(
            network, motion.frozen, lambda compute: self._kept(FEATURES, path, settings, compute)
        )

    def _landmarks(self, path: Path) -> Landmarks:
        setup, body = self._setup, self._setup.face
        if body is None:
            return Landmarks(reason="no body is given whose face could have landmarks")
        if "face" in setup.motion.frozen:
            return Landmarks(reason="the study holds the face still")
        rate, matrix = setup.face_rate, body.expression_matrix
        try:
            positions = self._kept(
                LANDMARKS,
                path,
                f"{rate!r} {setup.motion}",
                lambda clip: _landmarks_on(body).positions(resample(clip, rate)),
                *((body.path,) if matrix is None else (body.path, matrix)),
            )
        except InputError as error:
            return Landmarks(reason=error.what)
        return Landmarks(positions=positions.astype(np.float64))


@lru_cache(maxsize=2)
def penetrable_body(body: Path) -> PenetrableBody:
    """Return the body in a file, once per process.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    return PenetrableBody.of(read_body(body))


@lru_cache(maxsize=2)
def _landmarks_on(body: LandmarkBody) -> FaceLandmarks:
    return FaceLandmarks.of(read_body(body.path, expression_matrix=body.expression_matrix))
