"""Overlapping windows of speech: of live speech, or for windows of motion."""

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
from training.speech_features.spectra import check_speech, filterbank, log_mel, mfcc
from training.speech_features.speech_frames import at_speech_rate

FloatArray = NDArray[np.float32]

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
        (T, channels).
    first : int
        The frame of the speech that the window begins with.
    count : int
        The number of its frames with speech: all, except for the last window.
    """

    sound: Tensor
    spectrum: Tensor
    first: int
    count: int


def stream_windows(
    pieces: Iterable[FloatArray], frame_rate: float, frames: int, overlap: int
) -> Iterator[SpeechWindow]:
    """Yield windows of live speech as soon as they are complete.

    How the speech is cut into pieces changes nothing: all of it at once gives the same windows.

    Parameters
    ----------
    pieces : iterable of ndarray
        Samples at 16 kHz, in order.
    frame_rate : float
        Frames per second.
    frames, overlap : int
        Of a window, and what it shares with the next; what is new in one lasts whole seconds.
    """
    new = frames - overlap
    seconds, window_seconds = round(new / frame_rate), frames / frame_rate + _AFTER
    buffer, buffer_start, number = np.zeros(0, np.float32), 0, 0

    def end() -> int:
        return round((number * seconds + window_seconds) * SPEECH_RATE)

    def window(count: int) -> SpeechWindow:
        before = min(_BEFORE, number * seconds)
        sound = Audio(buffer[: end() - buffer_start], SPEECH_RATE)
        skipped = round(before * frame_rate)
        features = [
            torch.from_numpy(feature(sound, frame_rate, skipped + frames)[skipped:])
            for feature in (mfcc, log_mel)
        ]
        return SpeechWindow(features[0], features[1], number * new, count)

    for piece in pieces:
        buffer = np.concatenate([buffer, np.asarray(piece, np.float32)])
        while buffer_start + len(buffer) >= end():
            yield window(frames)
            number += 1
            dropped = (number * seconds - _BEFORE) * SPEECH_RATE
            buffer, buffer_start = buffer[dropped - buffer_start :], dropped
    remaining = round((buffer_start + len(buffer)) / SPEECH_RATE * frame_rate) - number * new
    while remaining > 0:
        yield window(min(remaining, frames))
        number, remaining = number + 1, remaining - new
        dropped = (number * seconds - _BEFORE) * SPEECH_RATE
        buffer, buffer_start = buffer[dropped - buffer_start :], dropped


@dataclass(frozen=True, kw_only=True)
class WindowPlan:
    """The number of windows of a motion, and their beginnings.

    Attributes
    ----------
    frames : int
        Of a window.
    stride : int
        Frames from the beginning of one window to that of the next.
    count : int
        Windows, from 1.
    fade : int
        Frames at a window's beginning in which it takes over from the one before.
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
        """Return windows (count, frames, width) as one motion, (frames in all, width).

        A window takes over from the one before along a quintic, whose speed and acceleration are
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
    """Return the fewest windows that cover `total` frames and share at least `fade`.

    They share as much as they can, so that the last hardly reaches beyond the speech.
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
