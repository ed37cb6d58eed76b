"""Speech features per frame of motion, of whole or of live speech."""

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
from training.speech_features.hubert import (
    RATE,
    Hubert,
    interpolate_features,
    resample_to_frames,
)
from training.speech_features.spectra import mel_bands


@dataclass(frozen=True, eq=False)
class SpeechFrames:
    """Features of speech, frame by frame.

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

    def slice(self, first: int, last: int | None = None) -> SpeechFrames:
        """Return some of the frames."""
        return SpeechFrames(self.mel[first:last], self.hubert[first:last])

    def followed_by(self, more: SpeechFrames) -> SpeechFrames:
        """Return these frames followed by `more`."""
        return SpeechFrames(torch.cat([self.mel, more.mel]), torch.cat([self.hubert, more.hubert]))


FloatArray = NDArray[np.float32]


@dataclass(frozen=True, kw_only=True)
class StreamWindow:
    """How much speech is encoded at once, and its context.

    Attributes
    ----------
    past : int
        Whole seconds before it, at least 1.
    ahead : float
        Seconds after it, at least a tenth: frames lag behind the speech by this and by the length
        of a chunk.
    at_once : int
        Whole seconds, at least 1.
    """

    past: int = 4
    ahead: float = 1.0
    at_once: int = 1

    def __str__(self) -> str:
        return f"{self.at_once} s at once with {self.past} s before and {self.ahead:g} s ahead"


LONGEST_AT_ONCE: Final = 90.0
"""Longest speech in seconds that HuBERT encodes at once; its time and memory grow with the
square."""

LONG_SPEECH_WINDOW: Final = StreamWindow(past=4, ahead=4.0, at_once=60)
"""The window of longer speech, such as the ten minutes of BEAT's conversations."""


def window_for(audio: Audio) -> StreamWindow | None:
    """Return the window of `extract_frames` for `audio`; None if it is encoded at once."""
    return LONG_SPEECH_WINDOW if audio.duration > LONGEST_AT_ONCE else None


def extract_frames(audio: Audio, frame_rate: float, hubert: Hubert) -> Iterator[SpeechFrames]:
    """Yield the frames of `audio`, at least one, in a memory that does not grow with its length.

    Up to `LONGEST_AT_ONCE` seconds each frame may depend on all of the speech, as the released
    network was fed; longer speech is encoded with the window `LONG_SPEECH_WINDOW`.

    Parameters
    ----------
    audio : Audio
        At any rate.
    frame_rate : float
        Frames per second of the motion, whole for long speech.
    hubert : Hubert
        The speech network.
    """
    window = window_for(audio)
    if window is None:
        yield extract_all_frames(audio, frame_rate, hubert)
        return
    remaining = round(audio.duration * frame_rate)
    for start in range(0, math.ceil(remaining / frame_rate), window.at_once):
        count = min(remaining, round(window.at_once * frame_rate))
        excerpt_start, end = max(0, start - window.past), start + window.at_once + window.ahead
        excerpt = audio.cut(excerpt_start, min(end, audio.duration))
        yield _frames_of_excerpt(excerpt, start - excerpt_start, count, frame_rate, hubert)
        remaining -= count


def extract_all_frames(audio: Audio, frame_rate: float, hubert: Hubert) -> SpeechFrames:
    """Return the frames of `audio`, at least one, each of which may depend on all of the speech.

    As the released network was fed. Memory and time of HuBERT grow with the square of the length;
    `extract_frames` and `stream_frames` bound both.
    """
    frames = max(1, round(audio.duration * frame_rate))
    features = hubert.features(at_speech_rate(audio))
    return SpeechFrames(
        torch.from_numpy(mel_bands(audio, frame_rate, frames)), resample_to_frames(features, frames)
    )


def stream_frames(
    pieces: Iterable[FloatArray],
    frame_rate: int,
    hubert: Hubert,
    window: StreamWindow,
) -> Iterator[SpeechFrames]:
    """Yield the frames of speech as soon as its look-ahead is available.

    How the speech is cut into pieces changes nothing: all of it at once gives the same frames, bit
    by bit. Never more than the window and the pieces at hand are kept.

    Parameters
    ----------
    pieces : iterable of ndarray
        Samples at 16 kHz, in order.
    frame_rate : int
        Frames per second of the motion.
    hubert : Hubert
        The speech network.
    window : StreamWindow
        What is encoded at once, and its context.

    Yields
    ------
    SpeechFrames
        Those of what is heard at once; the last may be fewer. As many in all as the speech lasts,
        rounded.
    """
    buffer, buffer_start, start = np.zeros(0, np.float32), 0, 0

    def frames(last: int, count: int) -> SpeechFrames:
        begin = max(0, start - window.past)
        sound = Audio(buffer[begin * SPEECH_RATE - buffer_start : last - buffer_start], SPEECH_RATE)
        return _frames_of_excerpt(sound, start - begin, count, frame_rate, hubert)

    for piece in pieces:
        buffer = np.concatenate([buffer, np.asarray(piece, np.float32)])
        while buffer_start + len(buffer) >= (
            last := round((start + window.at_once + window.ahead) * SPEECH_RATE)
        ):
            yield frames(last, window.at_once * frame_rate)
            start += window.at_once
            dropped = max(0, start - window.past) * SPEECH_RATE
            buffer, buffer_start = buffer[dropped - buffer_start :], dropped
    end = buffer_start + len(buffer)
    remaining = round(end / SPEECH_RATE * frame_rate) - start * frame_rate
    while remaining > 0:
        count = min(remaining, window.at_once * frame_rate)
        yield frames(min(end, round((start + window.at_once + window.ahead) * SPEECH_RATE)), count)
        start, remaining = start + window.at_once, remaining - count


def _frames_of_excerpt(
    excerpt: Audio, seconds_before: int, count: int, frame_rate: float, hubert: Hubert
) -> SpeechFrames:
    """Return `count` frames that begin this many whole seconds into their context."""
    skipped = round(seconds_before * frame_rate)
    mel = mel_bands(excerpt, frame_rate, skipped + count)[skipped:]
    times = seconds_before + np.arange(count) / frame_rate
    features = hubert.features(at_speech_rate(excerpt))
    return SpeechFrames(
        torch.from_numpy(mel), interpolate_features(features, torch.from_numpy(times * RATE))
    )


def at_speech_rate(audio: Audio) -> FloatArray:
    """Return the samples at 16 kHz."""
    return audio.samples_at(SPEECH_RATE).astype(np.float32)
