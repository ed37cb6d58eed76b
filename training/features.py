"""Features of takes: the conditions and targets of networks."""

import hashlib
from collections.abc import Callable
from dataclasses import replace
from typing import Final

import numpy as np

from motion.arrays import Floats, Floats32
from motion.audio import SPEECH_RATE, read_audio
from motion.body.face_landmarks import FaceLandmarks
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_motion
from motion.formats.beat_tracks import read_arkit_json, read_semantic_scores, semantic_weights
from motion.formats.clip_npz import read_clip
from motion.formats.joint_maps import choose_joint_map
from motion.formats.retarget import retarget
from motion.formats.smplx_rows import read_rows
from motion.formats.ted_npz import AXES, read_ted_npz
from motion.formats.transcript import read_transcript
from motion.resample import frame_positions, resample, slerp
from training.data.beat import read_beat_bvh
from training.data.take import Feature, Kind, Take
from training.spaces.beat import UPPER_BODY_JOINTS, body_values, face_values
from training.spaces.bones_and_landmarks import bone_and_landmark_values
from training.spaces.smplx_bodies import UPPER_BODY_JOINTS as SHOW_JOINTS
from training.spaces.smplx_bodies import show_values, smplx_6d_values
from training.speech_features.hubert import Hubert
from training.speech_features.spectra import (
    ROWS_PER_SECOND,
    check_speech,
    filterbank,
    log_mel,
    mel_bands,
    mfcc,
)
from training.speech_features.speech_frames import at_speech_rate, extract_frames
from training.speech_features.word_vectors import WordVectors, word_rows

VERSION: Final = "1"
"""Incremented whenever a feature of the same take changes."""

_SHOW_BODY: Final = 3 * len(SHOW_JOINTS)


def _feature(name: str, compute: Callable[[Take], Floats32], details: str = "") -> Feature:
    """Return a feature whose version has `details` of its settings."""
    return Feature(name=name, version=f"{VERSION} {details}".rstrip(), compute=compute)


def beat_gesture(frame_rate: float) -> Feature:
    """Return the rotations of BEAT's 47 joints, 141 channels, axis-angle in radians.

    Rotations between two recorded frames are interpolated along the shortest turn.
    """

    def compute(take: Take) -> Floats32:
        motion = read_beat_bvh(take)
        before, after, share = frame_positions(len(motion.values), motion.frame_rate, frame_rate)
        first, second = (
            _joints(body_values(replace(motion, values=motion.values[frames])))
            for frames in (before, after)
        )
        return slerp(first, second, share).reshape(len(before), -1)

    return _feature("gesture", compute)


def _joints(values: Floats) -> Floats32:
    return values.reshape(len(values), len(UPPER_BODY_JOINTS), 3).astype(np.float32)


def beat_expression(frame_rate: float) -> Feature:
    """Return BEAT's 51 facial weights, in [0, 1]."""

    def compute(take: Take) -> Floats32:
        return face_values(_facial_weights(take, frame_rate)).astype(np.float32)

    return _feature("expression", compute)


def _facial_weights(take: Take, frame_rate: float, alternative: str = "") -> Floats32:
    if take.face is None:
        raise InputError(
            "the take has no facial weights",
            where=take.motion,
            remedy=f"Put {take.motion.stem}.json next to it{alternative}",
        )
    return read_arkit_json(take.face, frame_rate)


def show_gesture(frame_rate: float) -> Feature:
    """Return the rotations of SHOW's 43 joints, 129 channels, axis-angle in radians."""
    return _feature("gesture", lambda take: _show_motion(take, frame_rate)[:, :_SHOW_BODY])


def show_expression(frame_rate: float) -> Feature:
    """Return SHOW's jaw (axis-angle) and 100 expression coefficients."""
    return _feature("expression", lambda take: _show_motion(take, frame_rate)[:, _SHOW_BODY:])


def _show_motion(take: Take, frame_rate: float) -> Floats32:
    return show_values(resample(read_smplx(take), frame_rate)).astype(np.float32)


def read_smplx(take: Take) -> MotionClip:
    """Return the SMPL-X motion of a take of SHOW or BEAT2, unchanged.

    Raises
    ------
    InputError
        If the file is unusable.
    """
    if take.motion.suffix.lower() == ".npy":
        return read_rows(take.motion)
    return read_clip(take.motion)


def mel(frame_rate: float) -> Feature:
    """Return the speech's power in 128 mel bands; see `mel_bands`."""
    return _feature("mel", lambda take: mel_bands(read_audio(take.speech), frame_rate))


def hubert_features(frame_rate: float, hubert: Hubert) -> Feature:
    """Return HuBERT's features of the speech, 1024 channels; see `extract_frames`."""

    def compute(take: Take) -> Floats32:
        chunks = extract_frames(read_audio(take.speech), frame_rate, hubert)
        return np.concatenate([chunk.hubert.numpy() for chunk in chunks])

    return _feature("hubert", compute, hubert.identity)


def semantic_scores(frame_rate: float) -> Feature:
    """Return the semantic relevance of the gesture in each frame, one channel, at least 0.

    Frames without a gesture and takes without annotation have 0.
    """

    def compute(take: Take) -> Floats32:
        frames = max(1, round(read_audio(take.speech).duration * frame_rate))
        spans = read_semantic_scores(take.semantic) if take.semantic else ()
        return semantic_weights(spans, frames, frame_rate).astype(np.float32)[:, None]

    return _feature("semantic", compute)


def whole_body(frame_rate: float) -> Feature:
    """Return the body's 6D rotations and translation, 333 channels, placed on the floor."""

    def compute(take: Take) -> Floats32:
        clip = resample(read_motion(take.motion), frame_rate)
        return smplx_6d_values(clip).astype(np.float32)

    return _feature("motion", compute)


def speech_filterbank(bands: int) -> Feature:
    """Return the standardised filterbank of the speech, one row per 10 ms."""

    def compute(take: Take) -> Floats32:
        samples = at_speech_rate(read_audio(take.speech))
        check_speech(samples)
        rows = round(len(samples) / SPEECH_RATE * ROWS_PER_SECOND)
        return np.asarray(filterbank(samples, rows, bands).numpy(), dtype=np.float32)

    return _feature("filterbank", compute, str(bands))


def bone_features(
    kind: Kind, face: FaceLandmarks, vectors: WordVectors, frame_rate: float, *, faces: bool
) -> tuple[Feature, ...]:
    """Return the features ``motion``, ``sound``, ``spectrum`` and ``words`` of a layout.

    Parameters
    ----------
    kind : {'beat', 'beat2', 'show', 'ted'}
        The layout.
    face : FaceLandmarks
        The landmarks of the face.
    vectors : WordVectors
        The word vectors.
    frame_rate : float
        Frames per second of all features.
    faces : bool
        Whether faces are learned; otherwise the landmarks are still.

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

    def motion(take: Take) -> Floats32:
        if kind == "ted":
            return _ted_values(take, frame_rate)
        clip = _resampled_clip(kind, take, frame_rate, faces=faces)
        return bone_and_landmark_values(clip, face if faces else None).astype(np.float32)

    def with_still_face(take: Take) -> Floats32:
        values = motion(take)
        still = np.zeros((len(values), 3 * face.count), np.float32)
        return np.concatenate([values, still], axis=1)

    def words(take: Take) -> Floats32:
        audio = read_audio(take.speech)
        spoken = () if take.transcript is None else read_transcript(take.transcript, audio)
        frames = max(1, round(audio.duration * frame_rate))
        return word_rows(spoken, vectors, frames, frame_rate)

    face_hash = hashlib.sha256(face.neutral.tobytes()).hexdigest()[:16]
    motion_version = f"{kind} {face_hash}" if faces else f"{kind} {face.count} still"
    return (
        _feature("motion", motion if faces else with_still_face, motion_version),
        _feature("sound", lambda take: mfcc(read_audio(take.speech), frame_rate)),
        _feature("spectrum", lambda take: log_mel(read_audio(take.speech), frame_rate)),
        _feature("words", words, f"{vectors.description} {vectors.width}"),
    )


def _ted_values(take: Take, frame_rate: float) -> Floats32:
    """Return directions of TED Gesture's bones, interpolated linearly between frames."""
    motion = read_ted_npz(take.motion)
    before, after, share = frame_positions(len(motion.directions), motion.frame_rate, frame_rate)
    share = np.reshape(share, (-1, 1, 1))
    blended = (1 - share) * motion.directions[before] + share * motion.directions[after]
    units = blended / np.linalg.norm(blended, axis=-1, keepdims=True)
    return np.asarray((units * AXES).reshape(len(units), -1), np.float32)


def _resampled_clip(kind: Kind, take: Take, frame_rate: float, *, faces: bool) -> MotionClip:
    if kind != "beat":
        return resample(read_smplx(take), frame_rate)
    motion = read_beat_bvh(take)
    _, joint_map = choose_joint_map(motion.joint_names)
    clip = resample(retarget(motion, joint_map), frame_rate)
    if not faces:
        return clip
    weights = _facial_weights(take, frame_rate, ", or train with --ablation without_face")
    frames = min(len(clip), len(weights))
    return replace(clip.frames(np.arange(frames)), arkit=weights[:frames])
