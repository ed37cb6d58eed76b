"""What metrics look at in one motion file, and how it is read."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.measurement.joint_motion import JointMotion, JointMotionStore, joint_motion
from analysis.measurement.kept_arrays import KeptArrays
from analysis.measurement.kept_onsets import onsets_of
from analysis.measurement.presets import Preset
from analysis.measurement.recorded_spread import RecordedSpread
from analysis.measurement.seen_motion import SeenMotion
from analysis.metrics.joint_positions import GESTURE_JOINTS
from motion.body import read_body
from motion.clip import MotionClip
from motion.errors import InputError
from motion.face_landmarks import FaceLandmarks
from motion.resample import resample
from motion.skeleton import joint_index

FloatArray = NDArray[np.float64]

LANDMARKS_VERSION: Final = "1"
"""Raised whenever the landmarks of the same motion file on the same body come to lie elsewhere."""

FACE_RATE = 15.0
"""Frames per second of faces and their landmarks; S2UE's and DiffSHEG's."""


@dataclass(frozen=True, kw_only=True)
class LandmarkBody:
    """Whose face landmarks are on.

    Attributes
    ----------
    path : Path
        The body's file.
    expression_matrix : Path or None
        As for `motion.body.read_body`.
    """

    path: Path
    expression_matrix: Path | None = None


@dataclass(frozen=True, kw_only=True)
class Bench:
    """How all clips are measured; the same for all segments.

    Attributes
    ----------
    frame_rate : float
        Frames per second at which clips are compared.
    motion : SeenMotion
        How motion files are read.
    preset : Preset
        Which metrics.
    spread : RecordedSpread or None
        Of all recordings, once it is known.
    store : JointMotionStore or None
        Where joint motions are kept between runs.
    face : LandmarkBody or None
        Whose face landmarks are on; without it there are none.
    """

    frame_rate: float
    motion: SeenMotion
    preset: Preset
    spread: RecordedSpread | None = None
    store: JointMotionStore | None = None
    face: LandmarkBody | None = None

    @property
    def face_rate(self) -> float:
        """Frames per second of faces."""
        return min(self.frame_rate, FACE_RATE)

    @property
    def landmark_settings(self) -> str:
        """What landmarks depend on besides the motion file; only with a `face`."""
        body = "" if self.face is None else _digest(self.face)
        return f"{self.face_rate!r} {self.motion} {body}"


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
class Landmarks:
    """Landmarks of a clip's face.

    Attributes
    ----------
    positions : ndarray, shape (T, L, 3), or None
        Metres, while the head is held still; None with a `reason`, and where nobody asks for them.
    reason : str
        Why there are none.
    """

    positions: FloatArray | None = None
    reason: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredClip:
    """What metrics look at in one clip.

    Attributes
    ----------
    joints : JointMotion
        Where the joints are.
    rotations : ndarray, shape (T, G, 3), or None
        Axis-angle of `analysis.metrics.joint_positions.GESTURE_JOINTS`, where a preset needs them.
    landmarks : Landmarks
        At `Bench.face_rate`.
    face : ndarray, shape (U, 52) or (U, 100), float32, or None
        ARKit weights, else SMPL-X coefficients, at `Bench.face_rate`; None where the clip has
        neither and where no preset needs them.
    """

    joints: JointMotion
    rotations: FloatArray | None = None
    landmarks: Landmarks = field(default_factory=Landmarks)
    face: NDArray[np.float32] | None = None


class Reader:
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

    def onsets(self, recording: Path, start: float, end: float) -> FloatArray:
        """Return when sounds begin in an excerpt of speech, in seconds.

        Raises
        ------
        InputError
            If it cannot be read.
        """
        folder = self._bench.store.folder if self._bench.store is not None else None
        return onsets_of(recording, start, end, folder)

    def _measured(self, path: Path) -> MeasuredClip:
        bench = self._bench
        place = self._place(path)
        joints = bench.store.read(place) if bench.store and place else None
        if joints is not None and not bench.preset.needs_clips:
            return MeasuredClip(joints=joints)
        clip = bench.motion.read(path)
        if joints is None:
            joints = joint_motion(clip, bench.frame_rate)
            if bench.store and place:
                bench.store.keep(place, joints)
        needs = bench.preset
        return MeasuredClip(
            joints=joints,
            rotations=_rotations(clip, bench.frame_rate) if needs.needs_rotations else None,
            landmarks=self._landmarks(path, clip) if needs.needs_landmarks else Landmarks(),
            face=_face(clip, bench) if needs.expression_distance else None,
        )

    def _place(self, path: Path) -> Path | None:
        """Return where the store keeps the clip's joint motion, if there is a store."""
        bench = self._bench
        if bench.store is None:
            return None
        place = bench.store.place(path, bench.frame_rate, bench.motion)
        self.kept.append(place)
        return place

    def _landmarks(self, path: Path, clip: MotionClip) -> Landmarks:
        bench = self._bench
        if bench.face is None:
            return Landmarks(reason="no body is given whose face could have landmarks")
        if "face" in bench.motion.frozen:
            return Landmarks(reason="the study holds the face still")
        place = None
        if bench.store is not None:
            place = kept_landmarks(bench.store.folder).place(path, bench.landmark_settings)
            self.kept.append(place)
            found = KeptArrays.read(place, (None, None, 3))
            if found is not None:
                return Landmarks(positions=found.astype(np.float64))
        try:
            made = _landmarks_on(bench.face).positions(resample(clip, bench.face_rate))
        except InputError as error:
            return Landmarks(reason=error.what)
        if place is not None:
            KeptArrays.keep(place, made)
        return Landmarks(positions=made.astype(np.float64))


def _rotations(clip: MotionClip, frame_rate: float) -> FloatArray:
    seen = resample(clip, frame_rate)
    return seen.poses[:, [joint_index(name) for name in GESTURE_JOINTS]].astype(np.float64)


def _face(clip: MotionClip, bench: Bench) -> NDArray[np.float32] | None:
    seen = resample(clip, bench.face_rate)
    return seen.arkit if seen.arkit is not None else seen.expressions


@lru_cache(maxsize=2)
def _landmarks_on(body: LandmarkBody) -> FaceLandmarks:
    return FaceLandmarks.of(read_body(body.path, expression_matrix=body.expression_matrix))


@lru_cache(maxsize=8)
def kept_landmarks(folder: Path) -> KeptArrays:
    """Return where landmarks are kept between runs."""
    return KeptArrays(folder, "landmarks", LANDMARKS_VERSION)


@lru_cache(maxsize=2)
def _digest(body: LandmarkBody) -> str:
    """Return a hash of all that decides where landmarks are."""
    digest = hashlib.sha256(body.path.read_bytes())
    if body.expression_matrix is not None:
        digest.update(body.expression_matrix.read_bytes())
    return digest.hexdigest()
