"""AMUSE's evaluator M: the emotion of a motion, by a transformer.

Chhatre et al. 2024, "Emotional Speech-driven 3D Body Animation via Disentangled Latent Diffusion",
section 5.1 and appendix D, after Petrovich et al. 2021. The paper appends a class token; the
released network averages over frames instead, and so does this one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import torch
from torch import Tensor, nn

from analysis.evaluators.clip_windows import LARGEST, WindowConfig


@dataclass(frozen=True, kw_only=True)
class EmotionConfig(WindowConfig):
    """Sizes of the network; those of AMUSE by default.

    Attributes
    ----------
    width : int
        Numbers of an embedding; a multiple of twice `heads`.
    feed_forward : int
        Hidden units of each layer.
    layers, heads : int
        Of the transformer.
    dropout : float
        In [0, 1).
    hidden : tuple of int
        Layers between embedding and emotions.
    """

    frame_rate: float = 30.0
    window: int = 300
    stride: int = 300
    width: int = 256
    feed_forward: int = 1024
    layers: int = 8
    heads: int = 4
    dropout: float = 0.1
    hidden: tuple[int, ...] = (128, 64)

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("width", "feed_forward", "layers", "heads"):
            self._check(name, 1 <= getattr(self, name) <= LARGEST, f"1 to {LARGEST}")
        self._check("width", self.width % (2 * self.heads) == 0, "a multiple of twice the heads")
        self._check("dropout", 0 <= self.dropout < 1, "a number from 0 to below 1")
        self._check("hidden", all(1 <= size <= LARGEST for size in self.hidden), f"1 to {LARGEST}")


FULL: Final = EmotionConfig()
"""AMUSE's: windows of ten seconds."""

TINY: Final = EmotionConfig(
    frame_rate=15.0,
    window=60,
    stride=15,
    width=64,
    feed_forward=128,
    layers=2,
    hidden=(32,),
)
"""For a processor: windows of four seconds."""


class EmotionNetwork(nn.Module):
    """Embeds windows of motion, and tells their emotion.

    Parameters
    ----------
    config : EmotionConfig
        Sizes.
    channels : int
        Numbers of a frame.
    emotions : int
        How many emotions are told apart.
    """

    positions: Tensor

    def __init__(self, config: EmotionConfig, channels: int, emotions: int) -> None:
        super().__init__()
        self.entry = nn.Linear(channels, config.width)
        self.register_buffer("positions", sinusoids(config.window, config.width), persistent=False)
        self.dropout = nn.Dropout(config.dropout)
        layer = nn.TransformerEncoderLayer(
            config.width,
            config.heads,
            config.feed_forward,
            config.dropout,
            activation="gelu",
            batch_first=True,
        )
        self.encoder = nn.TransformerEncoder(layer, config.layers, enable_nested_tensor=False)
        sizes = (config.width, *config.hidden)
        parts: list[nn.Module] = []
        for size, following in pairwise(sizes):
            parts += [nn.Linear(size, following), nn.ReLU(), nn.Dropout(config.dropout)]
        self.classifier = nn.Sequential(*parts, nn.Linear(sizes[-1], emotions))

    def embed(self, windows: Tensor) -> Tensor:
        """Return the mean over frames of the last layer, shape (n, width)."""
        frames = self.dropout(self.entry(windows) + self.positions)
        embedded: Tensor = self.encoder(frames).mean(dim=1)
        return embedded

    def forward(self, windows: Tensor) -> Tensor:
        """Return the logits of the emotions, shape (n, emotions), of windows (n, T, channels)."""
        logits: Tensor = self.classifier(self.embed(windows))
        return logits

    def losses(self, windows: Tensor, labels: Tensor) -> Mapping[str, Tensor]:
        """Return the cross-entropy of a batch, as AMUSE's appendix D has it."""
        return {"loss": nn.functional.cross_entropy(self(windows), labels)}

    def measured(self, windows: Tensor, labels: Tensor) -> Mapping[str, Tensor]:
        """Return the cross-entropy and the accuracy of a batch."""
        logits = self(windows)
        return {
            "loss": nn.functional.cross_entropy(logits, labels),
            "accuracy": (logits.argmax(dim=1) == labels).double().mean(),
        }


def sinusoids(length: int, width: int) -> Tensor:
    """Return the positions of Vaswani et al. 2017, section 3.5, shape (length, width)."""
    rates = torch.exp(torch.arange(0, width, 2) * (-math.log(10_000.0) / width))
    angles = torch.arange(length)[:, None] * rates
    return torch.stack([angles.sin(), angles.cos()], dim=2).reshape(length, width)
