"""Speech features per frame of motion, of whole or live speech, and in overlapping windows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import torch
from torch import Tensor

from motion.arrays import Floats32
from motion.audio import SPEECH_RATE, Audio
from training.layers.interpolation import interpolate_features
from training.speech_features.hubert import RATE, Hubert, resample_to_frames
from training.speech_features.spectra import check_speech, filterbank, log_mel, mel_bands, mfcc


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


@dataclass(frozen=True, kw_only=True)
class StreamWindow:
    """The amount of speech that is encoded at once, and its context.

    Attributes
    ----------
    past : int
        Context before the window in whole seconds, at least 1.
    ahead : float
        Context after the window in seconds, at least 0.1: frames lag behind the speech by this and
        by the length of a chunk.
    at_once : int
        Length of the window in whole seconds, at least 1.
    """

    past: int = 4
    ahead: float = 1.0
    at_once: int = 1

    def __str__(self) -> str:
        return f"{self.at_once} s at once with {self.past} s before and {self.ahead:g} s ahead"


LONGEST_AT_ONCE: Final = 90.0
"""Longest speech in seconds that HuBERT encodes at once; time and memory are quadratic in it."""

LONG_SPEECH_WINDOW: Final = StreamWindow(past=4, ahead=4.0, at_once=60)
"""The window for longer speech, such as BEAT's ten-minute conversations."""


def window_for(audio: Audio) -> StreamWindow | None:
    """Return the window of `extract_frames` for `audio`; None if it is encoded at once."""
    return LONG_SPEECH_WINDOW if audio.duration > LONGEST_AT_ONCE else None


def extract_frames(audio: Audio, frame_rate: float, hubert: Hubert) -> Iterator[SpeechFrames]:
    """Yield the frames of `audio`, at least one, in memory that does not grow with its length.

    Up to `LONGEST_AT_ONCE` seconds, each frame may depend on all of the speech, as in the release;
    longer speech is encoded in windows, `LONG_SPEECH_WINDOW`.

    Parameters
    ----------
    audio : Audio
        The speech at any rate.
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
    """Return the frames of `audio`, at least one; each may depend on all of it, as in the release.

    HuBERT's memory and time grow with the square of the length; `extract_frames` and
    `stream_frames` bound both.
    """
    frames = max(1, round(audio.duration * frame_rate))
    features = hubert.features(at_speech_rate(audio))
    return SpeechFrames(
        torch.from_numpy(mel_bands(audio, frame_rate, frames)), resample_to_frames(features, frames)
    )


def stream_frames(
    chunks: Iterable[Floats32], frame_rate: int, hubert: Hubert, window: StreamWindow
) -> Iterator[SpeechFrames]:
    """Yield the frames of speech as soon as their look-ahead is available.

    The division into chunks does not matter: all of the speech at once gives the same frames, bit
    by bit. Only the window and the current chunk are kept.

    Parameters
    ----------
    chunks : iterable of ndarray
        Samples at 16 kHz, in order.
    frame_rate : int
        Frames per second of the motion.
    hubert : Hubert
        The speech network.
    window : StreamWindow
        The length and the context of the speech that is encoded at once.

    Yields
    ------
    SpeechFrames
        The frames of one window; the last one may have fewer. Their total is the duration of the
        speech in frames, rounded.
    """
    excerpts = _stream_excerpts(
        chunks,
        frame_rate,
        step=window.at_once,
        frames=window.at_once * frame_rate,
        past=window.past,
        ahead=window.ahead,
    )
    for excerpt, seconds_before, count in excerpts:
        yield _frames_of_excerpt(excerpt, seconds_before, count, frame_rate, hubert)


def _stream_excerpts(
    chunks: Iterable[Floats32],
    frame_rate: float,
    *,
    step: int,
    frames: int,
    past: int,
    ahead: float,
) -> Iterator[tuple[Audio, int, int]]:
    """Yield the speech of each window as soon as it is complete.

    Windows of `frames` begin every `step` whole seconds. An excerpt also has up to `past` whole
    seconds before its window, and `ahead` seconds after it. It is yielded with the number of
    seconds before its window, and the number of the window's frames that are speech: all of them,
    except in the last windows.
    """
    buffer, buffer_start, start = np.zeros(0, np.float32), 0, 0
    window_seconds = frames / frame_rate + ahead

    def excerpt() -> tuple[Audio, int]:
        return Audio(buffer[: excerpt_length()], SPEECH_RATE), start - buffer_start

    def excerpt_length() -> int:
        return round((start + window_seconds) * SPEECH_RATE) - buffer_start * SPEECH_RATE

    def advance() -> None:
        nonlocal buffer, buffer_start, start
        start += step
        dropped = max(0, start - past) - buffer_start
        buffer, buffer_start = buffer[dropped * SPEECH_RATE :], buffer_start + dropped

    for chunk in chunks:
        buffer = np.concatenate([buffer, np.asarray(chunk, np.float32)])
        while len(buffer) >= excerpt_length():
            yield *excerpt(), frames
            advance()
    new_frames = round(step * frame_rate)
    duration = (buffer_start * SPEECH_RATE + len(buffer)) / SPEECH_RATE
    remaining = round(duration * frame_rate) - round(start * frame_rate)
    while remaining > 0:
        yield *excerpt(), min(remaining, frames)
        advance()
        remaining -= new_frames


def _frames_of_excerpt(
    excerpt: Audio, seconds_before: int, count: int, frame_rate: float, hubert: Hubert
) -> SpeechFrames:
    """Return the `count` frames of an excerpt that begin after `seconds_before`."""
    skipped = round(seconds_before * frame_rate)
    mel = mel_bands(excerpt, frame_rate, skipped + count)[skipped:]
    times = seconds_before + np.arange(count) / frame_rate
    features = hubert.features(at_speech_rate(excerpt))
    return SpeechFrames(
        torch.from_numpy(mel), interpolate_features(features, torch.from_numpy(times * RATE))
    )


def at_speech_rate(audio: Audio) -> Floats32:
    """Return the samples of `audio` at 16 kHz."""
    return audio.samples_at(SPEECH_RATE).astype(np.float32)


_BEFORE: Final = 1
"""Whole seconds of context before a window."""

_AFTER: Final = 0.1
"""Seconds of context after a window."""


@dataclass(frozen=True)
class SpeechWindow:
    """The features of a window: MFCC and spectrogram, and which of its frames are speech.

    Attributes
    ----------
    sound, spectrum : Tensor
        MFCC and spectrogram, (T, channels).
    first : int
        Index of the window's first frame in the speech.
    count : int
        Number of frames with speech: all, except in the last window.
    """

    sound: Tensor
    spectrum: Tensor
    first: int
    count: int


def stream_windows(
    chunks: Iterable[Floats32], frame_rate: float, frames: int, overlap: int
) -> Iterator[SpeechWindow]:
    """Yield windows of live speech as soon as they are complete.

    The division into chunks does not matter: all of the speech at once gives the same windows.

    Parameters
    ----------
    chunks : iterable of ndarray
        Samples at 16 kHz, in order.
    frame_rate : float
        Frames per second.
    frames, overlap : int
        Frames of a window, and frames that it shares with the next one; their difference must last
        whole seconds.
    """
    new = frames - overlap
    excerpts = _stream_excerpts(
        chunks,
        frame_rate,
        step=round(new / frame_rate),
        frames=frames,
        past=_BEFORE,
        ahead=_AFTER,
    )
    for number, (excerpt, seconds_before, count) in enumerate(excerpts):
        skipped = round(seconds_before * frame_rate)
        sound, spectrum = (
            torch.from_numpy(feature(excerpt, frame_rate, skipped + frames)[skipped:])
            for feature in (mfcc, log_mel)
        )
        yield SpeechWindow(sound, spectrum, number * new, count)


@dataclass(frozen=True, kw_only=True)
class WindowPlan:
    """The number of windows of a motion, and their starts.

    Attributes
    ----------
    frames : int
        Frames of a window.
    stride : int
        Frames from the start of one window to that of the next.
    count : int
        Number of windows, at least 1.
    fade : int
        Frames at a window's start over which it fades in.
    """

    frames: int
    stride: int
    count: int
    fade: int = 0

    @property
    def starts(self) -> list[int]:
        """First frame of each window."""
        return [self.stride * number for number in range(self.count)]

    def join(self, windows: Tensor) -> Tensor:
        """Join windows (count, frames, width) into one motion, (frames in all, width).

        A window fades in over the previous one along a quintic, whose speed and acceleration are
        zero at both ends (Flash & Hogan 1985).
        """
        share = (torch.arange(self.fade, device=windows.device) + 1) / (self.fade + 1)
        weight = (share**3 * (10 - 15 * share + 6 * share**2))[:, None]
        motion = windows.new_empty(self.starts[-1] + self.frames, windows.shape[-1])
        motion[: self.frames] = windows[0]
        for window, start in zip(windows[1:], self.starts[1:], strict=True):
            faded = start + self.fade
            motion[start:faded] = torch.lerp(motion[start:faded], window[: self.fade], weight)
            motion[faded : start + self.frames] = window[self.fade :]
        return motion


def plan_windows(total: int, frames: int, fade: int) -> WindowPlan:
    """Return the fewest windows that cover `total` frames and overlap by at least `fade`.

    They overlap as much as they can, so that the last one hardly extends past the speech.
    """
    count = 1 if total <= frames else 1 + math.ceil((total - frames) / (frames - fade))
    stride = frames if count == 1 else math.ceil((total - frames) / (count - 1))
    return WindowPlan(frames=frames, stride=stride, count=count, fade=fade)


def filterbanks_under(
    audio: Audio, plan: WindowPlan, frame_rate: float, rows: int, bands: int
) -> list[Tensor]:
    """Return the standardised filterbank (1, rows, bands) of the speech under each window.

    Raises
    ------
    InputError
        If the speech is shorter than half a second, or silent.
    """
    samples = at_speech_rate(audio)
    check_speech(samples)
    ends = [
        [round(frame * SPEECH_RATE / frame_rate) for frame in (start, start + plan.frames)]
        for start in plan.starts
    ]
    return [filterbank(samples[first:last], rows, bands)[None] for first, last in ends]
