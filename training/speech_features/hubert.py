"""HuBERT's features of speech: 1024 channels, 50 times a second.

Hsu et al. 2021. Its weights are a gigabyte and not part of the installation: they are read from a
folder that the researcher names, and nothing is downloaded. Without them a stand-in is used. The
motion then follows the timing of speech but not its words, and its provenance says so.

HuBERT's features describe the sounds around a moment, including syllables and their stress, for
which a motion can prepare. A network of its architecture with random weights captures little of
that. The stand-in has pitch bands of about a second, mixed by seeded weights, and also loudness,
its rise, and local maxima of loudness, which mark stressed syllables.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, cast

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from motion.arrays import Floats32
from motion.audio import SPEECH_RATE
from motion.audio_analysis import load_librosa
from motion.files import sha256_of
from training.device import check_device
from training.layers.interpolation import interpolate_features
from training.released_weights import CONFIG, WEIGHTS, SavedNetworks

WINDOW: Final = 400
"""Samples of a feature's window, as in HuBERT's first layers."""

HOP: Final = 320
_BANDS: Final = 40
_OFFSETS: Final = tuple(range(-24, 25, 4))
"""Offsets of the pitch bands that a feature depends on: half a second on either side."""

_STRESS_OFFSETS: Final = tuple(range(-36, 37, 2))
"""Offsets of loudness and syllables: seven tenths of a second, in which an arm is raised."""

_LOUDEST_WITHIN: Final = (5, 10, 15)
"""Steps before and after within which the loudest one marks a syllable: 0.1 to 0.3 s."""

_QUIETEST: Final = 1e-2
"""Power below which sound of unit variance counts as silence."""

_CENTRE, _SPREAD = 1.0, 4.5
"""Mean and standard deviation of the log power of speech."""


@dataclass(frozen=True, eq=False)
class HubertOutput:
    """The features (1, n, channels), named as in transformers' outputs."""

    last_hidden_state: Tensor


class SoundContext(nn.Module):
    """Encodes pitch bands within half a second of each moment, and syllables within 0.7 s.

    Parameters
    ----------
    channels : int
        Number of features, at least 186.
    seed : int
        Seed of the weights that mix bands and moments.
    """

    filters: Tensor
    hann: Tensor
    mix: Tensor

    def __init__(self, channels: int, seed: int) -> None:
        super().__init__()
        size = 512
        librosa = load_librosa()
        filters = librosa.filters.mel(sr=SPEECH_RATE, n_fft=size, n_mels=_BANDS, norm=None)
        band_features = _BANDS * len(_OFFSETS)
        mixed = channels - (2 + len(_LOUDEST_WITHIN)) * len(_STRESS_OFFSETS)
        chance = torch.Generator().manual_seed(seed)
        self._size = size
        self.register_buffer("filters", torch.from_numpy(filters.astype(np.float32)))
        self.register_buffer("hann", torch.hann_window(WINDOW))
        self.register_buffer(
            "mix", torch.randn(band_features, mixed, generator=chance) / math.sqrt(band_features)
        )

    def forward(self, samples: Tensor) -> HubertOutput:
        """Return features of sound of unit variance, (1, N) samples at 16 kHz."""
        windows = samples[0].unfold(0, WINDOW, HOP) * self.hann
        loudness = windows.square().mean(dim=1).pow(0.3)
        power = torch.fft.rfft(windows, self._size).abs().square() @ self.filters.T
        bands = ((power + _QUIETEST).log() - _CENTRE) / _SPREAD
        silence = (math.log(_QUIETEST) - _CENTRE) / _SPREAD
        # Means over five steps, so that none between two offsets is skipped.
        context = _means(bands, _OFFSETS, spread=2, padding=silence)
        stress = _means(_stress_features(loudness), _STRESS_OFFSETS, spread=1, padding=0.0)
        features = torch.cat([(context @ self.mix).tanh(), stress], dim=1)
        return HubertOutput(features[None])


def _stress_features(loudness: Tensor) -> Tensor:
    """Return loudness (n,), its rise, and its local maxima, (n, 5)."""
    # Rises and peaks are rare and small: scaled so that they vary about as much as loudness does.
    rise = 5 * functional.pad(loudness.diff(), (1, 0)).clamp(min=0)
    peaks = [
        3 * loudness * (loudness >= functional.max_pool1d(loudness[None], 2 * r + 1, 1, r)[0])
        for r in _LOUDEST_WITHIN
    ]
    return torch.stack([loudness, rise, *peaks], dim=1)


def _means(values: Tensor, offsets: Sequence[int], *, spread: int, padding: float) -> Tensor:
    """Return the means of `values` (n, c) over ± `spread` at each offset, (n, offsets · c)."""
    margin = offsets[-1] + spread
    padded = functional.pad(values, (0, 0, margin, margin), value=padding)
    smooth = padded.unfold(0, 2 * spread + 1, 1).mean(dim=-1)
    return torch.cat([smooth[offsets[-1] + offset :][: len(values)] for offset in offsets], dim=1)


FEATURES: Final = 1024
RATE: Final = 50
"""Feature vectors per second."""

_SEED: Final = 20_210_614
_HUBERT_FOLDER: Final = SavedNetworks(
    owner="HuBERT",
    types={"hubert": "HuBERT-large"},
    # It masks parts of the speech, only in training.
    optional=("masked_spec_embed",),
    remedy="Save it there once: transformers.HubertModel.from_pretrained("
    "'facebook/hubert-large-ls960-ft').save_pretrained(FOLDER)",
)


@dataclass(frozen=True, eq=False)
class Hubert:
    """A network of speech features.

    Attributes
    ----------
    network : Module
        ``transformers.HubertModel`` or its stand-in.
    description : str
        Its description in provenance.
    stands_in : bool
        Whether it is the stand-in, with seeded weights.
    identity : str
        Equal for networks with the same features, wherever their weights are.
    device : str
        The network's device.
    """

    network: nn.Module
    description: str
    stands_in: bool
    identity: str
    device: str = "cpu"

    def to_device(self, device: str) -> Hubert:
        """Move the network to a device and return it; its features are still on the CPU.

        Raises
        ------
        InputError
            If the device is not usable.
        """
        check_device(device)
        return replace(self, network=self.network.to(device), device=device)

    def features(self, samples: Floats32) -> Tensor:
        """Return the features of speech, (n, 1024).

        Parameters
        ----------
        samples : ndarray, shape (N,)
            Samples at 16 kHz. Feature k depends on the 400 samples from 320 k on; samples after the
            last whole window are ignored. Speech shorter than 400 samples is padded with silence.
        """
        samples = np.pad(samples, (0, max(0, WINDOW - len(samples))))
        # The released network was trained on speech of zero mean and unit variance.
        normalised = (samples - samples.mean()) / np.sqrt(samples.var() + 1e-7)
        with torch.inference_mode():
            tensor = torch.from_numpy(normalised.astype(np.float32))[None].to(self.device)
            return cast("Tensor", self.network(tensor).last_hidden_state)[0].cpu()


def load_hubert(folder: Path) -> Hubert:
    """Load HuBERT from a local folder.

    Parameters
    ----------
    folder : Path
        A folder of ``HubertModel.save_pretrained``: ``config.json`` and ``model.safetensors``.

    Raises
    ------
    InputError
        If the folder has another network, lacks a weight, or has other than 1024 channels.
    """
    width = _HUBERT_FOLDER.check(folder).get("hidden_size")
    if width != FEATURES:
        raise _HUBERT_FOLDER.error(
            f"the network has {width} channels, not HuBERT-large's {FEATURES}", folder / CONFIG
        )
    network = _HUBERT_FOLDER.load(folder)
    sha256 = sha256_of(folder / WEIGHTS)
    return Hubert(
        network=network.eval(),
        description=f"{folder.name} (sha256 {sha256})",
        stands_in=False,
        identity=f"sha256 {sha256}",
    )


def stand_in() -> Hubert:
    """Return the stand-in for HuBERT, `SoundContext`."""
    name = f"stand-in for HuBERT, pitch bands and syllables of a second, seed {_SEED}"
    network = SoundContext(FEATURES, _SEED).eval()
    return Hubert(network=network, description=name, stands_in=True, identity=name)


def resample_to_frames(features: Tensor, frames: int) -> Tensor:
    """Return `features` (n, channels) at `frames` evenly spaced moments, from first to last.

    Linear interpolation with aligned corners, as in the release.
    """
    return interpolate_features(
        features, torch.linspace(0, len(features) - 1, frames, dtype=torch.float64)
    )
