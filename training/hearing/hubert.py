"""What is said, as HuBERT hears it: 1024 channels, 50 times a second.

Hsu et al. 2021. Its weights are a gigabyte that belongs to nobody's installation: they are read
from a folder that the researcher names, and nothing is ever fetched. Without them
`training.hearing.sound_context` stands in; the motion then knows when somebody speaks, but not
what, and says so.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, Protocol, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from motion.audio import SPEECH_RATE
from training.hearing.sound_context import SoundContext
from training.pretrained import CONFIG, WEIGHTS, SavedNetworks

FEATURES: Final = 1024
RATE: Final = 50
"""Feature vectors per second."""

_SHORTEST: Final = 400
"""Samples that one feature vector looks at."""

_SEED: Final = 20_210_614
_SAVED: Final = SavedNetworks(
    whose="HuBERT",
    types={"hubert": "HuBERT-large"},
    # It hides parts of the speech, in training alone.
    unasked=("masked_spec_embed",),
    remedy="Save it there once: transformers.HubertModel.from_pretrained("
    "'facebook/hubert-large-ls960-ft').save_pretrained(FOLDER)",
)


class _Network(Protocol):
    def __call__(self, samples: Tensor) -> object: ...

    def to(self, device: str) -> _Network: ...


@dataclass(frozen=True, eq=False)
class Hubert:
    """A network that hears speech.

    Attributes
    ----------
    network : callable
        ``transformers.HubertModel``, or what stands in for it.
    description : str
        Which one it is, as provenance quotes it.
    stands_in : bool
        Whether its weights are seeded and not learned.
    identity : str
        Equal for networks that hear alike, wherever their weights lie.
    device : str
        Where the network is.
    """

    network: _Network
    description: str
    stands_in: bool
    identity: str
    device: str = "cpu"

    def on(self, device: str) -> Hubert:
        """Return the network, moved to a device; what it hears still comes back to the CPU."""
        network = self.network.to(device)
        return replace(self, network=network, device=device)

    def hear(self, samples: NDArray[np.float32]) -> Tensor:
        """Return the features of speech, (n, 1024).

        Parameters
        ----------
        samples : ndarray, shape (N,)
            At 16 kHz. Feature k looks at the 400 samples from 320 k on; what lies behind the last
            whole stretch is not heard. Speech of less than 400 is continued by silence.
        """
        samples = np.pad(samples, (0, max(0, _SHORTEST - len(samples))))
        # The released network learned from speech without offset and of unit variance.
        even = (samples - samples.mean()) / np.sqrt(samples.var() + 1e-7)
        with torch.inference_mode():
            heard = torch.from_numpy(even.astype(np.float32))[None].to(self.device)
            found = self.network(heard)
            return cast("Tensor", found.last_hidden_state)[0].cpu()  # type: ignore[attr-defined]


def load_hubert(folder: Path) -> Hubert:
    """Return the network of a local folder.

    Parameters
    ----------
    folder : Path
        What ``HubertModel.save_pretrained`` wrote: ``config.json`` and ``model.safetensors``.

    Raises
    ------
    InputError
        If the folder holds no such network, lacks a weight, or gives other than 1024 channels.
    """
    check_hubert(folder)
    network = _SAVED.load(folder)
    with (folder / WEIGHTS).open("rb") as file:
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()
    return Hubert(
        network=network.eval(),
        description=f"{folder.name} (sha256 {sha256})",
        stands_in=False,
        identity=f"sha256 {sha256}",
    )


def check_hubert(folder: Path) -> None:
    """Say what is wrong with a folder of HuBERT; nothing is loaded."""
    width = _SAVED.check(folder).get("hidden_size")
    if width != FEATURES:
        raise _SAVED.refused(
            f"the network has {width} channels, not HuBERT-large's {FEATURES}", folder / CONFIG
        )


def stand_in(*, full_size: bool = False) -> Hubert:
    """Return what stands in for HuBERT where its weights are not at hand.

    Parameters
    ----------
    full_size : bool
        A network of HuBERT-large's own size with seeded weights, which takes as long as the real
        one. Else `SoundContext`, which hears ten seconds in no time.
    """
    network: _Network
    if full_size:
        from transformers import HubertConfig, HubertModel

        config = HubertConfig(
            hidden_size=FEATURES,
            num_hidden_layers=24,
            num_attention_heads=16,
            intermediate_size=4096,
            feat_extract_norm="layer",
            conv_bias=True,
            do_stable_layer_norm=True,
        )
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(_SEED)
            network = HubertModel(config).eval().requires_grad_(False)
        name = f"stand-in for HuBERT, full size, seed {_SEED}"
    else:
        network = SoundContext(FEATURES, _SEED).eval()
        name = f"stand-in for HuBERT, pitch bands and syllables of a second, seed {_SEED}"
    return Hubert(network=network, description=name, stands_in=True, identity=name)


def at_frames(features: Tensor, frames: int) -> Tensor:
    """Return `features` (n, channels) at `frames` moments: first at first, last at last.

    Linear interpolation with aligned corners, as the release takes 50 a second to the motion's.
    """
    return at_places(features, torch.linspace(0, len(features) - 1, frames, dtype=torch.float64))


def at_places(features: Tensor, places: Tensor) -> Tensor:
    """Return `features` (n, channels) at fractional `places`, linearly between neighbours."""
    places = places.clamp(0, len(features) - 1)
    before = places.floor().long()
    after = (before + 1).clamp(max=len(features) - 1)
    share = (places - before).to(features.dtype)[:, None]
    return (1 - share) * features[before] + share * features[after]


def feature_places(times: NDArray[np.float64]) -> Tensor:
    """Return which feature lies at each of `times`, in seconds from the first sample heard."""
    return torch.from_numpy(times * RATE)


def samples_of(seconds: float) -> int:
    """Return how many samples HuBERT hears in so many seconds."""
    return round(seconds * SPEECH_RATE)
