"""Motion of any length, window after window: each begins with the end of the one before."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from generators.s2ue.model import Network
from training.hearing.speech_windows import HeardWindow
from training.hearing.word_vectors import words_in
from training.spaces.bone_tensors import with_units

FloatArray = NDArray[np.float32]

_FADES: Final = 0.4
"""Of a window's new frames, over which it comes to where it would be without the one before."""


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
        said = words_in(words, window.first, config.frames, config.words)
        with torch.inference_mode():
            found, _ = network.synthesise(
                window.sound[None].to(told.device),
                torch.from_numpy(said)[None].to(told.device),
                person[None],
                noise[None],
                told[None],
            )
            lips = network.lips(window.spectrum[None].to(told.device))
            values = network.with_lips(found, lips)[0]
            values = values + away * (told - values[:seeds]).mean(dim=0)
            values[:seeds] = torch.lerp(told, values[:seeds], share)
            values = with_units(values)
        whole = window.count == config.frames
        told = values[new:]
        yield values[: new if whole else window.count].cpu().numpy().astype(np.float64)


def _fading(seeds: int, new: int) -> Tensor:
    """Return a window's shares of how far it begins from the one before, (T, 1)."""
    lasts = round(_FADES * new)
    falling = 0.5 + 0.5 * torch.cos(torch.pi * torch.arange(1, lasts + 1) / (lasts + 1))
    return torch.cat([torch.ones(seeds), falling, torch.zeros(new - lasts)])[:, None]
