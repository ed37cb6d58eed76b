"""Motion of any length, window after window: each begins with the end of the one before."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from generators.s2ue.model import Network, points_of
from motion.audio import SPEECH_RATE, Audio
from training.hearing.mfcc import log_mel, mfcc
from training.spaces.bones_and_landmarks import BONE_VALUES

FloatArray = NDArray[np.float32]

_BEFORE: Final = 1
"""Whole seconds before a window that are heard with it."""

_FADES: Final = 0.4
"""Of a window's new frames, over which it comes to where it would be without the one before."""

AHEAD: Final = 0.1
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


def hear(pieces: Iterable[FloatArray], network: Network) -> Iterator[HeardWindow]:
    """Yield windows of speech as soon as they are heard.

    How the speech is cut into pieces changes nothing: all of it at once gives the same windows.

    Parameters
    ----------
    pieces : iterable of ndarray
        Samples at 16 kHz, in order.
    network : Network
        Whose windows they are; what is new in one lasts whole seconds.
    """
    config = network.config
    rate, new = config.frame_rate, config.frames - config.seeds
    seconds, lasts = round(new / rate), config.frames / rate + AHEAD
    kept, first, number = np.zeros(0, np.float32), 0, 0

    def end() -> int:
        return round((number * seconds + lasts) * SPEECH_RATE)

    def window(count: int) -> HeardWindow:
        before = min(_BEFORE, number * seconds)
        sound = Audio(kept[: end() - first], SPEECH_RATE)
        skipped = round(before * rate)
        heard = [
            torch.from_numpy(told(sound, rate, skipped + config.frames)[skipped:])
            for told in (mfcc, log_mel)
        ]
        return HeardWindow(heard[0], heard[1], number * new, count)

    for piece in pieces:
        kept = np.concatenate([kept, np.asarray(piece, np.float32)])
        while first + len(kept) >= end():
            yield window(config.frames)
            number += 1
            forgotten = (number * seconds - _BEFORE) * SPEECH_RATE
            kept, first = kept[forgotten - first :], forgotten
    left = round((first + len(kept)) / SPEECH_RATE * rate) - number * new
    while left > 0:
        yield window(min(left, config.frames))
        number, left = number + 1, left - new
        forgotten = (number * seconds - _BEFORE) * SPEECH_RATE
        kept, first = kept[forgotten - first :], forgotten


def move(
    windows: Iterable[HeardWindow],
    words: FloatArray | None,
    network: Network,
    person: Tensor,
    noise: Tensor,
) -> Iterator[NDArray[np.float64]]:
    """Yield values of motion (some frames, 27 + 3 L), as soon as they are settled.

    Of each window the first frames are what the one before ended with; there one goes over into
    the other, and by how much they are apart on the average fades while the window goes on.
    The first one begins at rest, as recordings do.

    Parameters
    ----------
    windows : iterable of HeardWindow
        What is heard.
    words : ndarray, shape (frames, width), optional
        The vector of the word in each frame of the speech; None where nobody knows the words.
    network : Network
        In evaluation mode.
    person, noise : Tensor
        See `generators.s2ue.model.Generator`, for a single window.
    """
    config = network.config
    seeds, new = config.seeds, config.frames - config.seeds
    told = network.rest.expand(seeds, -1)
    share = torch.linspace(0, 1, seeds + 2, device=told.device)[1:-1, None]
    away = _fading(seeds, new).to(told.device)
    for window in windows:
        with torch.inference_mode():
            found, _ = network.synthesise(
                window.sound[None].to(told.device),
                _words_in(window, words, config.words, config.frames)[None].to(told.device),
                person[None],
                noise[None],
                told[None],
            )
            lips = network.lips(window.spectrum[None].to(told.device))
            values = network.with_lips(found, lips)[0]
            values = values + away * (told - values[:seeds]).mean(dim=0)
            values[:seeds] = torch.lerp(told, values[:seeds], share)
            values = _with_units(values)
        whole = window.count == config.frames
        told = values[new:]
        yield values[: new if whole else window.count].cpu().numpy().astype(np.float64)


def _fading(seeds: int, new: int) -> Tensor:
    """Return a window's shares of how far it begins from the one before, (T, 1)."""
    lasts = round(_FADES * new)
    falling = 0.5 + 0.5 * torch.cos(torch.pi * torch.arange(1, lasts + 1) / (lasts + 1))
    return torch.cat([torch.ones(seeds), falling, torch.zeros(new - lasts)])[:, None]


def _words_in(window: HeardWindow, words: FloatArray | None, width: int, frames: int) -> Tensor:
    """Return the vectors of the words in a window, zeros outside of the speech."""
    found = torch.zeros(frames, width)
    if words is not None:
        said = words[window.first : window.first + frames]
        found[: len(said)] = torch.from_numpy(said)
    return found


def _with_units(values: Tensor) -> Tensor:
    """Return values whose directions have length 1 (equation 2)."""
    bones = functional.normalize(points_of(values[:, :BONE_VALUES]), dim=-1)
    return torch.cat([bones.flatten(-2), values[:, BONE_VALUES:]], dim=-1)
