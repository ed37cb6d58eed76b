"""What a network is told of the speech, all at once or while somebody still speaks."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from motion.audio import SPEECH_RATE, Audio
from motion.errors import InputError
from training.hearing.hubert import Hubert, at_frames, at_places, feature_places, samples_of
from training.hearing.spectra import REACH, mel_bands


@dataclass(frozen=True, eq=False)
class SpeechFrames:
    """What is known of the speech, frame by frame.

    Attributes
    ----------
    mel : Tensor
        (frames, mel bands).
    hubert : Tensor
        (frames, speech features).
    """

    mel: Tensor
    hubert: Tensor

    def __len__(self) -> int:
        return len(self.mel)

    def part(self, first: int, last: int | None = None) -> SpeechFrames:
        """Return some of the frames."""
        return SpeechFrames(self.mel[first:last], self.hubert[first:last])

    def then(self, more: SpeechFrames) -> SpeechFrames:
        """Return these frames followed by `more`."""
        return SpeechFrames(torch.cat([self.mel, more.mel]), torch.cat([self.hubert, more.hubert]))


FloatArray = NDArray[np.float32]


@dataclass(frozen=True, kw_only=True)
class HearingWindow:
    """How much speech is heard at once, and how much around it.

    Attributes
    ----------
    past : int
        Whole seconds before it, at least 1.
    ahead : float
        Seconds after it, at least a tenth: by so much, and by what is heard at once, frames lag
        behind the speech.
    at_once : int
        Whole seconds, at least 1.
    """

    past: int = 4
    ahead: float = 1.0
    at_once: int = 1

    def __post_init__(self) -> None:
        if self.past < 1 or self.ahead < max(0.1, REACH) or self.at_once < 1:
            raise InputError(
                f"speech cannot be heard {self.at_once} s at once with {self.past} s before and "
                f"{self.ahead:g} s ahead",
                remedy="Give whole seconds from 1 at once and before, and at least 0.1 s ahead",
            )

    def __str__(self) -> str:
        return f"{self.at_once} s at once with {self.past} s before and {self.ahead:g} s ahead"


LONGEST_WHOLE: Final = 90.0
"""Seconds of speech up to which HuBERT hears all of it at once; its time and memory grow with the
square."""

LONG: Final = HearingWindow(past=4, ahead=4.0, at_once=60)
"""How longer speech is heard, such as the ten minutes of BEAT's conversations."""


def hearing_of(audio: Audio) -> HearingWindow | None:
    """Return the window by which `hear` hears `audio`; None where it hears all of it at once."""
    return LONG if audio.duration > LONGEST_WHOLE else None


def hear(audio: Audio, frame_rate: float, hubert: Hubert) -> Iterator[SpeechFrames]:
    """Yield the frames of `audio`, at least one, in a memory that does not grow with its length.

    Up to `LONGEST_WHOLE` seconds each frame may depend on all of the speech, as the released
    network was fed; longer speech is heard by the window `LONG`.

    Parameters
    ----------
    audio : Audio
        At any rate.
    frame_rate : float
        Frames per second of the motion, whole for long speech.
    hubert : Hubert
        The network that hears.
    """
    window = hearing_of(audio)
    if window is None:
        yield hear_whole(audio, frame_rate, hubert)
        return
    left = round(audio.duration * frame_rate)
    for start in range(0, math.ceil(left / frame_rate), window.at_once):
        count = min(left, round(window.at_once * frame_rate))
        begin, end = max(0, start - window.past), start + window.at_once + window.ahead
        heard = audio.cut(begin, min(end, audio.duration))
        yield _part_of(heard, start - begin, count, frame_rate, hubert)
        left -= count


def hear_whole(audio: Audio, frame_rate: float, hubert: Hubert) -> SpeechFrames:
    """Return the frames of `audio`, at least one, each of which may depend on all of the speech.

    As the released network was fed. Memory and time of HuBERT grow with the square of the length;
    `hear` and `hear_stream` bound both.
    """
    frames = max(1, round(audio.duration * frame_rate))
    heard = hubert.hear(at_speech_rate(audio))
    return SpeechFrames(
        torch.from_numpy(mel_bands(audio, frame_rate, frames)), at_frames(heard, frames)
    )


def hear_stream(
    pieces: Iterable[FloatArray],
    frame_rate: int,
    hubert: Hubert,
    window: HearingWindow,
) -> Iterator[SpeechFrames]:
    """Yield the frames of speech as soon as what lies ahead of it is known.

    How the speech is cut into pieces changes nothing: all of it at once gives the same frames, bit
    by bit. Never more than the window and the pieces at hand are kept.

    Parameters
    ----------
    pieces : iterable of ndarray
        Samples at 16 kHz, in order.
    frame_rate : int
        Frames per second of the motion.
    hubert : Hubert
        The network that hears.
    window : HearingWindow
        What it hears at once, and around it.

    Yields
    ------
    SpeechFrames
        Those of what is heard at once; the last may be fewer. As many in all as the speech lasts,
        rounded.
    """
    kept, first, start = np.zeros(0, np.float32), 0, 0

    def frames(last: int, count: int) -> SpeechFrames:
        begin = max(0, start - window.past)
        sound = Audio(kept[begin * SPEECH_RATE - first : last - first], SPEECH_RATE)
        return _part_of(sound, start - begin, count, frame_rate, hubert)

    for piece in pieces:
        kept = np.concatenate([kept, np.asarray(piece, np.float32)])
        while first + len(kept) >= (last := samples_of(start + window.at_once + window.ahead)):
            yield frames(last, window.at_once * frame_rate)
            start += window.at_once
            forgotten = max(0, start - window.past) * SPEECH_RATE
            kept, first = kept[forgotten - first :], forgotten
    end = first + len(kept)
    left = round(end / SPEECH_RATE * frame_rate) - start * frame_rate
    while left > 0:
        count = min(left, window.at_once * frame_rate)
        yield frames(min(end, samples_of(start + window.at_once + window.ahead)), count)
        start, left = start + window.at_once, left - count


def _part_of(
    sound: Audio, seconds_before: int, count: int, frame_rate: float, hubert: Hubert
) -> SpeechFrames:
    """Return `count` frames that begin so many whole seconds into what is heard around them."""
    skipped = round(seconds_before * frame_rate)
    mel = mel_bands(sound, frame_rate, skipped + count)[skipped:]
    times = seconds_before + np.arange(count) / frame_rate
    heard = hubert.hear(at_speech_rate(sound))
    return SpeechFrames(torch.from_numpy(mel), at_places(heard, feature_places(times)))


def at_speech_rate(audio: Audio) -> FloatArray:
    """Return the samples at 16 kHz."""
    return audio.samples_at(SPEECH_RATE).astype(np.float32)
