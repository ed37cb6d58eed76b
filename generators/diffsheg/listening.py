"""What the network is told of the speech, all at once or while somebody still speaks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import gcd

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.signal import resample_poly

from generators.diffsheg.estimates import SpeechFrames
from generators.diffsheg.hubert import Hubert, at_frames, at_places, feature_places, samples_of
from generators.diffsheg.mel import REACH, mel_bands
from motion.audio import SPEECH_RATE, Audio
from motion.errors import InputError

FloatArray = NDArray[np.float32]


@dataclass(frozen=True, kw_only=True)
class HearingWindow:
    """How much speech is heard around each second of it.

    Attributes
    ----------
    past : int
        Whole seconds before it, at least 1.
    ahead : float
        Seconds after it, at least a tenth: by so much, and the second itself, frames lag behind
        the speech.
    """

    past: int = 4
    ahead: float = 1.0

    def __post_init__(self) -> None:
        if self.past < 1 or self.ahead < max(0.1, REACH):
            raise InputError(
                f"speech cannot be heard with {self.past} s before and {self.ahead:g} s ahead",
                remedy="Give whole seconds from 1 before, and at least 0.1 s ahead",
            )


def hear_whole(audio: Audio, frame_rate: float, hubert: Hubert) -> SpeechFrames:
    """Return the frames of `audio`, at least one, each of which may depend on all of the speech.

    As the released network was fed. Memory and time of HuBERT grow with the square of the length;
    `hear_stream` bounds both.
    """
    frames = max(1, round(audio.duration * frame_rate))
    heard = hubert.hear(_at_speech_rate(audio))
    return SpeechFrames(
        torch.from_numpy(mel_bands(audio, frame_rate, frames)), at_frames(heard, frames)
    )


def hear_stream(
    pieces: Iterable[FloatArray],
    frame_rate: int,
    hubert: Hubert,
    window: HearingWindow,
) -> Iterator[SpeechFrames]:
    """Yield the frames of each second of speech as soon as what lies ahead of it is known.

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
        What it hears around each second.

    Yields
    ------
    SpeechFrames
        A second's frames; the last may be fewer. As many in all as the speech lasts, rounded.
    """
    kept, first, second = np.zeros(0, np.float32), 0, 0

    def frames(last: int, count: int) -> SpeechFrames:
        begin = max(0, second - window.past)
        sound = kept[begin * SPEECH_RATE - first : last - first]
        return _second_of(sound, second - begin, count, frame_rate, hubert)

    for piece in pieces:
        kept = np.concatenate([kept, np.asarray(piece, np.float32)])
        while first + len(kept) >= (last := samples_of(second + 1 + window.ahead)):
            yield frames(last, frame_rate)
            second += 1
            forgotten = max(0, second - window.past) * SPEECH_RATE
            kept, first = kept[forgotten - first :], forgotten
    end = first + len(kept)
    left = round(end / SPEECH_RATE * frame_rate) - second * frame_rate
    while left > 0:
        last = min(end, samples_of(second + 1 + window.ahead))
        yield frames(last, min(left, frame_rate))
        second, left = second + 1, left - frame_rate


def _second_of(
    sound: FloatArray, seconds_before: int, count: int, frame_rate: int, hubert: Hubert
) -> SpeechFrames:
    """Return `count` frames that begin so many whole seconds into what is heard around them."""
    skipped = seconds_before * frame_rate
    mel = mel_bands(Audio(sound, SPEECH_RATE), frame_rate, skipped + count)[skipped:]
    times = seconds_before + np.arange(count) / frame_rate
    return SpeechFrames(torch.from_numpy(mel), at_places(hubert.hear(sound), feature_places(times)))


def _at_speech_rate(audio: Audio) -> FloatArray:
    if audio.sample_rate == SPEECH_RATE:
        return audio.samples
    common = gcd(SPEECH_RATE, audio.sample_rate)
    return np.asarray(
        resample_poly(audio.samples, SPEECH_RATE // common, audio.sample_rate // common),
        dtype=np.float32,
    )
