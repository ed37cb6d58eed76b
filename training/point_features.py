"""Takes as directions of bones and landmarks of the face, and what is heard and said in them."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.audio import read_audio
from motion.body.face_landmarks import FaceLandmarks
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats.arkit_json import read_arkit_json
from motion.formats.joint_maps import choose_joint_map
from motion.formats.retarget import retarget
from motion.formats.ted_npz import AXES, read_ted_npz
from motion.formats.transcript import read_transcript
from motion.resample import frame_places, resample
from training.data.beat_bvh import read_beat_bvh
from training.data.feature import Feature
from training.data.take import Kind, Take
from training.features import read_smplx
from training.hearing.spectra import log_mel, mfcc
from training.hearing.word_vectors import WordVectors, word_rows
from training.spaces.bones_and_landmarks import values_of

FloatArray = NDArray[np.float32]

VERSION: Final = "1"


def features_of(
    kind: Kind, face: FaceLandmarks, vectors: WordVectors, frame_rate: float, *, faces: bool
) -> tuple[Feature, ...]:
    """Return ``motion``, ``sound``, ``spectrum`` and ``words`` of takes of a layout.

    Parameters
    ----------
    kind : {'beat', 'beat2', 'show', 'ted'}
        The layout.
    face : FaceLandmarks
        The landmarks.
    vectors : WordVectors
        Of words.
    frame_rate : float
        Frames per second of all of them.
    faces : bool
        Whether faces are learned; else landmarks are still.

    Raises
    ------
    InputError
        If faces are to be learned from a layout that has none.
    """
    if kind == "ted" and faces:
        raise InputError(
            "recordings of the layout 'ted' have no face",
            remedy="Train with --ablation without_face, or give recordings with faces",
        )

    def motion(take: Take) -> FloatArray:
        if kind == "ted":
            return _ted_values(take, frame_rate)
        clip = _clip_of(kind, take, frame_rate, faces=faces)
        return values_of(clip, face if faces else None).astype(np.float32)

    def with_still_face(take: Take) -> FloatArray:
        values = motion(take)
        still = np.zeros((len(values), 3 * face.count), np.float32)
        return np.concatenate([values, still], axis=1)

    def words(take: Take) -> FloatArray:
        audio = read_audio(take.speech)
        said = () if take.transcript is None else read_transcript(take.transcript, audio)
        frames = max(1, round(audio.duration * frame_rate))
        return word_rows(said, vectors, frames, frame_rate)

    mark = hashlib.sha256(face.neutral.tobytes()).hexdigest()[:16]
    told = f"{kind} {mark}" if faces else f"{kind} {face.count} still"
    return (
        Feature(
            name="motion",
            version=f"{VERSION} {told}",
            compute=motion if faces else with_still_face,
        ),
        Feature(
            name="sound",
            version=VERSION,
            compute=lambda take: mfcc(read_audio(take.speech), frame_rate),
        ),
        Feature(
            name="spectrum",
            version=VERSION,
            compute=lambda take: log_mel(read_audio(take.speech), frame_rate),
        ),
        Feature(
            name="words",
            version=f"{VERSION} {vectors.description} {vectors.width}",
            compute=words,
        ),
    )


def _ted_values(take: Take, frame_rate: float) -> FloatArray:
    """Return directions of TED Gesture's bones; between frames they are shares of both."""
    motion = read_ted_npz(take.motion)
    before, after, share = frame_places(len(motion.directions), motion.frame_rate, frame_rate)
    share = np.reshape(share, (-1, 1, 1))
    mixed = (1 - share) * motion.directions[before] + share * motion.directions[after]
    units = mixed / np.linalg.norm(mixed, axis=-1, keepdims=True)
    return np.asarray((units * AXES).reshape(len(units), -1), np.float32)


def _clip_of(kind: Kind, take: Take, frame_rate: float, *, faces: bool) -> MotionClip:
    if kind != "beat":
        return resample(read_smplx(take), frame_rate)
    if faces and take.face is None:
        raise InputError(
            "the take has no facial weights",
            where=take.motion,
            remedy=f"Put {take.motion.stem}.json beside it, or train with --ablation without_face",
        )
    motion = read_beat_bvh(take)
    _, joint_map = choose_joint_map(motion.joint_names)
    clip = resample(retarget(motion, joint_map), frame_rate)
    if take.face is None or not faces:
        return clip
    weights = read_arkit_json(take.face, frame_rate)
    frames = min(len(clip), len(weights))
    return replace(clip.frames(np.arange(frames)), arkit=weights[:frames])
