"""Windows of speech that overlap, as soon as they are heard: cepstral coefficients and spectrum."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from motion.audio import SPEECH_RATE, Audio
from training.hearing.spectra import log_mel, mfcc

FloatArray = NDArray[np.float32]

_BEFORE: Final = 1
"""Whole seconds before a window that are heard with it."""

_AHEAD: Final = 0.1
"""Seconds behind a window that are heard with it."""


@dataclass(frozen=True)
class HeardWindow:
    """What is heard in a window: MFCC and spectrogram, and which of its frames are speech.

    Attributes
    ----------
    sound, spectrum : Tensor
        (T, channels).
    first : int
        The frame of the speech that the window begins with.
    count : int
        How many of its frames are speech: all, but of the last window.
    """

    sound: Tensor
    spectrum: Tensor
    first: int
    count: int


def hear_windows(
    pieces: Iterable[FloatArray], frame_rate: float, frames: int, overlap: int
) -> Iterator[HeardWindow]:
    """Yield windows of speech as soon as they are heard.

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
    seconds, lasts = round(new / frame_rate), frames / frame_rate + _AHEAD
    kept, first, number = np.zeros(0, np.float32), 0, 0

    def end() -> int:
        return round((number * seconds + lasts) * SPEECH_RATE)

    def window(count: int) -> HeardWindow:
        before = min(_BEFORE, number * seconds)
        sound = Audio(kept[: end() - first], SPEECH_RATE)
        skipped = round(before * frame_rate)
        heard = [
            torch.from_numpy(told(sound, frame_rate, skipped + frames)[skipped:])
            for told in (mfcc, log_mel)
        ]
        return HeardWindow(heard[0], heard[1], number * new, count)

    for piece in pieces:
        kept = np.concatenate([kept, np.asarray(piece, np.float32)])
        while first + len(kept) >= end():
            yield window(frames)
            number += 1
            forgotten = (number * seconds - _BEFORE) * SPEECH_RATE
            kept, first = kept[forgotten - first :], forgotten
    left = round((first + len(kept)) / SPEECH_RATE * frame_rate) - number * new
    while left > 0:
        yield window(min(left, frames))
        number, left = number + 1, left - new
        forgotten = (number * seconds - _BEFORE) * SPEECH_RATE
        kept, first = kept[forgotten - first :], forgotten
