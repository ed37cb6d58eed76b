"""What stands in for HuBERT: how the sound goes around each moment, and where it has its syllables.

HuBERT's features tell of the sounds before and after a moment what a motion can prepare for, its
syllables and their stress among it. A network of its make with random weights tells little of
them. This one tells pitch bands of about a second, mixed by seeded weights, and beside them how
loud it is, how fast it grows louder, and which moments are the loudest around: where syllables
with stress lie. It tells nothing of words.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from motion.audio import SPEECH_RATE
from motion.speech.audio_analysis import load_librosa

WINDOW: Final = 400
"""Samples that a feature looks at itself, as HuBERT's first layers do."""

HOP: Final = 320
_BANDS: Final = 40
_OFFSETS: Final = tuple(range(-24, 25, 4))
"""Features before and after, of which each tells: half a second on either side."""

_STRESS_OFFSETS: Final = tuple(range(-36, 37, 2))
"""The same of loudness and syllables: seven tenths of a second, in which an arm is raised."""

_LOUDEST_WITHIN: Final = (5, 10, 15)
"""Features before and after, of which the loudest is a syllable's: 0.1 to 0.3 s."""

_QUIETEST: Final = 1e-2
"""Power below which sound of unit variance counts as silence."""

_CENTRE, _SPREAD = 1.0, 4.5
"""Mean and deviation of the logarithms of the power of speech."""


@dataclass(frozen=True, eq=False)
class Heard:
    """What was heard, named as transformers' networks name it.

    Attributes
    ----------
    last_hidden_state : Tensor
        (1, n, channels).
    """

    last_hidden_state: Tensor


class SoundContext(nn.Module):
    """Hears pitch bands for half a second on either side of each moment, syllables for 0.7 s.

    Parameters
    ----------
    channels : int
        Of the features, at least 186.
    seed : int
        Of the weights that mix bands and moments.
    """

    filters: Tensor
    hann: Tensor
    mix: Tensor

    def __init__(self, channels: int, seed: int) -> None:
        super().__init__()
        size = 512
        librosa = load_librosa()
        filters = librosa.filters.mel(sr=SPEECH_RATE, n_fft=size, n_mels=_BANDS, norm=None)
        told = _BANDS * len(_OFFSETS)
        mixed = channels - (2 + len(_LOUDEST_WITHIN)) * len(_STRESS_OFFSETS)
        chance = torch.Generator().manual_seed(seed)
        self._size = size
        self.register_buffer("filters", torch.from_numpy(filters.astype(np.float32)))
        self.register_buffer("hann", torch.hann_window(WINDOW))
        self.register_buffer("mix", torch.randn(told, mixed, generator=chance) / math.sqrt(told))

    def forward(self, samples: Tensor) -> Heard:
        """Return features of sound of unit variance, (1, N) samples at 16 kHz."""
        windows = samples[0].unfold(0, WINDOW, HOP) * self.hann
        loudness = windows.square().mean(dim=1).pow(0.3)
        power = torch.fft.rfft(windows, self._size).abs().square() @ self.filters.T
        bands = ((power + _QUIETEST).log() - _CENTRE) / _SPREAD
        silence = (math.log(_QUIETEST) - _CENTRE) / _SPREAD
        # Means over five features, so that none between two offsets is passed over.
        around = _around(bands, _OFFSETS, spread=2, outside=silence)
        stress = _around(_stress(loudness), _STRESS_OFFSETS, spread=1, outside=0.0)
        return Heard(torch.cat([(around @ self.mix).tanh(), stress], dim=1)[None])


def _stress(loudness: Tensor) -> Tensor:
    """Return loudness (n,), its rise, and where it is the greatest of its surroundings, (n, 5)."""
    # Rises and peaks are rare and small: scaled so that they vary about as much as loudness does.
    rise = 5 * functional.pad(loudness.diff(), (1, 0)).clamp(min=0)
    peaks = [
        3 * loudness * (loudness >= functional.max_pool1d(loudness[None], 2 * near + 1, 1, near)[0])
        for near in _LOUDEST_WITHIN
    ]
    return torch.stack([loudness, rise, *peaks], dim=1)


def _around(values: Tensor, offsets: Sequence[int], *, spread: int, outside: float) -> Tensor:
    """Return the means of `values` (n, c) over ± `spread` at each offset, (n, offsets · c)."""
    reach = offsets[-1] + spread
    padded = functional.pad(values, (0, 0, reach, reach), value=outside)
    smooth = padded.unfold(0, 2 * spread + 1, 1).mean(dim=-1)
    return torch.cat([smooth[offsets[-1] + offset :][: len(values)] for offset in offsets], dim=1)
