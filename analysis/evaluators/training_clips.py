"""The recorded clips that a network is trained on."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from analysis.evaluators.clip_views import long_enough
from motion.arrays import Floats32
from motion.clip import MotionClip
from motion.errors import InputError


@dataclass(frozen=True, kw_only=True)
class ClipSource:
    """A clip for training.

    Attributes
    ----------
    name : str
        A unique name.
    recording : str
        The recording it is cut from; clips of one recording are held out together.
    emotion : str
        Its label; empty where unknown.
    sha256 : str
        Hash of its file.
    read : callable
        Returns the clip, or raises `InputError`.
    """

    name: str
    recording: str
    emotion: str
    sha256: str
    read: Callable[[], MotionClip]


@dataclass(frozen=True, kw_only=True, eq=False)
class TrainingClips:
    """Clips that were read.

    Attributes
    ----------
    sources : tuple of ClipSource
        The usable clips, ordered by name.
    frames : tuple of ndarray, shape (T, C), float32
        The network's input of each, at its frame rate.
    skipped : tuple of InputError
        Errors of the others.
    """

    sources: tuple[ClipSource, ...]
    frames: tuple[Floats32, ...]
    skipped: tuple[InputError, ...]

    @property
    def sha256(self) -> str:
        """Hash of the clips' files, recordings and emotions."""
        digest = hashlib.sha256()
        for source in self.sources:
            facts = (source.name, source.recording, source.emotion, source.sha256)
            digest.update(repr(facts).encode())
        return digest.hexdigest()

    @property
    def seen_sha256(self) -> str:
        """Hash of `sha256` and of the network's input: the same files may be read differently."""
        digest = hashlib.sha256(self.sha256.encode())
        for frames in self.frames:
            digest.update(np.ascontiguousarray(frames).data)
        return digest.hexdigest()


def read_training_clips(
    sources: Iterable[ClipSource],
    read_input: Callable[[MotionClip], Floats32],
    *,
    window: int,
    frame_rate: float,
    needs_emotion: bool,
    show: Callable[[int, int], None] | None = None,
) -> TrainingClips:
    """Read clips and list those that cannot be used.

    Parameters
    ----------
    sources : iterable of ClipSource
        The clips.
    read_input : callable
        Returns the network's input of a clip at its frame rate, shape (T, C).
    window : int
        Frames of a window; shorter clips cannot be used.
    frame_rate : float
        Frames per second of the input.
    needs_emotion : bool
        Whether clips without a label are unusable.
    show : callable, optional
        Called with the number of clips read, and of all.
    """
    ordered = sorted(sources, key=lambda source: source.name)
    used: list[ClipSource] = []
    frames: list[Floats32] = []
    skipped: list[InputError] = []
    for number, source in enumerate(ordered, start=1):
        try:
            if needs_emotion and not source.emotion:
                raise InputError(
                    "its emotion is not stated",
                    remedy="Name it in segments.csv with its emotion",
                )
            clip = long_enough(read_input(source.read()), window, frame_rate)
        except InputError as error:
            where = error.where or source.name
            skipped.append(InputError(error.what, where=where, remedy=error.remedy))
        else:
            used.append(source)
            frames.append(clip)
        if show is not None:
            show(number, len(ordered))
    return TrainingClips(sources=tuple(used), frames=tuple(frames), skipped=tuple(skipped))
