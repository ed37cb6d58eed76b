"""The interface of generators: speech and a seed in, a motion clip out."""

import zlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from motion.audio import Audio
from motion.clip import MotionClip
from motion.errors import InputError
from motion.segment import Segment


@dataclass(frozen=True, kw_only=True)
class SpeechSegment:
    """A speech segment together with its sound.

    Attributes
    ----------
    segment : Segment
        Text, speaker and emotion of the excerpt.
    audio : Audio
        Sound of the excerpt only, not the whole recording.
    """

    segment: Segment
    audio: Audio

    def frame_count(self, frame_rate: float) -> int:
        """Return the number of frames of a motion to this speech at `frame_rate`.

        Raises
        ------
        InputError
            If the speech is shorter than one frame.
        """
        frames = round(self.audio.duration * frame_rate)
        if frames < 1:
            raise InputError(
                f"segment {self.segment.name}: its speech of {self.audio.duration:.4f} s is "
                f"shorter than one frame at {frame_rate:g} fps",
                remedy="Give a longer excerpt",
            )
        return frames


OnPart = Callable[[int, int], object]
"""Called with the number of finished parts of a clip and the number of all parts."""


def ignore_progress(made: int, parts: int) -> None:
    """Do nothing."""


class StudyClips(Protocol):
    """The clips that one condition of a study already has, for generators that need a source."""

    @property
    def segments(self) -> Sequence[Segment]:
        """All segments of the study, in the study's order."""
        ...

    def clip(self, segment_name: str) -> MotionClip:
        """Return the condition's clip for the segment of that name."""
        ...


@dataclass(frozen=True, kw_only=True)
class ClipRequest:
    """The arguments of `Generator.generate`, which explains them."""

    speech: SpeechSegment
    seed: int
    frame_rate: float
    source: StudyClips | None
    on_part: OnPart

    @property
    def frames(self) -> int:
        """The number of frames of the clip; see `SpeechSegment.frame_count`."""
        return self.speech.frame_count(self.frame_rate)


class Generator(ABC):
    """Makes motion to speech.

    Attributes
    ----------
    name : str
        The name it is registered under.
    version : str
        Incremented with every change, in whatever module, by which the same speech and seed give
        another clip: clips of another version are made again. Tests pin each version's output.
    """

    name: ClassVar[str]
    version: ClassVar[str]

    def generate(
        self,
        speech: SpeechSegment,
        *,
        seed: int,
        frame_rate: float,
        source: StudyClips | None = None,
        on_part: OnPart = ignore_progress,
    ) -> MotionClip:
        """Return motion to `speech`.

        Parameters
        ----------
        speech : SpeechSegment
            The speech of the clip.
        seed : int
            Random seed, at least 0. Equal seeds give equal clips, byte for byte.
        frame_rate : float
            Frames per second of the result.
        source : StudyClips or None
            The condition whose clips it may use; see `generators.registry.needs_source`.
        on_part : callable
            Called with (parts made, parts in all) by generators that are slow.

        Returns
        -------
        MotionClip
            Exactly ``round(speech.audio.duration * frame_rate)`` frames; its provenance holds
            ``generator``, ``seed`` and ``segment``.

        Raises
        ------
        InputError
            If the speech, the seed or the source cannot be used.
        """
        request = ClipRequest(
            speech=speech, seed=seed, frame_rate=frame_rate, source=source, on_part=on_part
        )
        return self.make_clip(request).with_provenance(
            generator=self.name, seed=str(seed), segment=speech.segment.name
        )

    @abstractmethod
    def make_clip(self, request: ClipRequest) -> MotionClip:
        """Return the clip, with further facts as its provenance."""


def seeded_stream(seed: int, *purpose: str) -> tuple[int, ...]:
    """Return entropy for `numpy.random.default_rng` that depends on `seed` and `purpose`."""
    return (seed, *(zlib.crc32(word.encode()) for word in purpose))


def with_length(clip: MotionClip, frames: int) -> MotionClip:
    """Return `clip` cut to `frames`, or extended without a jump if it is too short.

    The extension runs backwards from the last frame, then forwards again from the first.
    """
    there_and_back = np.concatenate([np.arange(len(clip)), np.arange(len(clip) - 2, 0, -1)])
    return clip.frames(np.resize(there_and_back, frames))
