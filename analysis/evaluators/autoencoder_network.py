"""An autoencoder of short windows of motion: convolutions over time, then one vector.

Designed as the feature network of Yoon et al. 2020, "Speech Gesture Generation from the Trimodal
Context of Text, Audio, and Speaker Identity", which BEAT (Liu et al. 2022) and DiffSHEG (Chen et
al. 2024) use with more features. Speech2UnifiedExpressions trains one on face landmarks for its FLD
and does not state its layers; it has those of Yoon here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from torch import Tensor, nn

from analysis.evaluators.clip_windows import LARGEST, WindowConfig

_SLOPE: Final = 0.2
"""Of the leaky rectifiers."""

_SHORTEST: Final = 12
"""Frames that the encoder's convolutions need."""


@dataclass(frozen=True, kw_only=True)
class AutoencoderConfig(WindowConfig):
    """Sizes of the network.

    Attributes
    ----------
    features : int
        Numbers of an embedding; the convolutions have as many channels, or twice as many.
    """

    frame_rate: float = 15.0
    window: int = 34
    stride: int = 10
    features: int = 300

    def __post_init__(self) -> None:
        super().__post_init__()
        self._check("window", self.window >= _SHORTEST, f"at least {_SHORTEST} frames")
        self._check("features", 1 <= self.features <= LARGEST, f"1 to {LARGEST}")


MOTION_FULL: Final = AutoencoderConfig()
"""BEAT's 300 features."""

FACE_FULL: Final = AutoencoderConfig(features=64)
"""For face landmarks, of which Speech2UnifiedExpressions states no size."""

SMALL: Final = AutoencoderConfig(features=32)
"""Yoon's 32 features: enough for a processor."""


class AutoencoderNetwork(nn.Module):
    """Turns windows into vectors, and vectors back into windows.

    Parameters
    ----------
    config : AutoencoderConfig
        Sizes.
    channels : int
        Numbers of a frame.
    """

    def __init__(self, config: AutoencoderConfig, channels: int) -> None:
        super().__init__()
        size = config.features
        left = (config.window - 8) // 2 - 1  # frames after four convolutions: 12 of 34
        self.encoder = nn.Sequential(
            *_convolved(channels, size),
            *_convolved(size, 2 * size),
            *_convolved(2 * size, 2 * size, kernel=4, stride=2),
            nn.Conv1d(2 * size, size, 3),
            nn.Flatten(),
            *_connected(left * size, 4 * size),
            *_connected(4 * size, 2 * size),
            nn.Linear(2 * size, size),
        )
        self.decoder = nn.Sequential(
            *_connected(size, 2 * size),
            nn.Linear(2 * size, config.window * size),
            nn.Unflatten(1, (size, config.window)),
            *_convolved(size, 2 * size, padding=1),
            *_convolved(2 * size, 2 * size, padding=1),
            nn.Conv1d(2 * size, channels, 3, padding=1),
        )

    def embed(self, windows: Tensor) -> Tensor:
        """Return the vectors, shape (n, features), of windows (n, T, channels)."""
        embedded: Tensor = self.encoder(windows.transpose(1, 2))
        return embedded

    def forward(self, windows: Tensor) -> Tensor:
        """Return the windows as they are rebuilt from their vectors, shape (n, T, channels)."""
        rebuilt: Tensor = self.decoder(self.embed(windows))
        return rebuilt.transpose(1, 2)

    def losses(self, windows: Tensor, labels: Tensor) -> Mapping[str, Tensor]:
        """Return the errors of a batch, in deviations of the training frames.

        The loss is the mean absolute error of values and of their changes from frame to frame (Yoon
        et al. 2020).
        """
        rebuilt = self(windows)
        error = nn.functional.l1_loss(rebuilt, windows)
        change = nn.functional.l1_loss(rebuilt.diff(dim=1), windows.diff(dim=1))
        return {"loss": error + change, "error": error, "change": change}

    def measured(self, windows: Tensor, labels: Tensor) -> Mapping[str, Tensor]:
        """Return the errors of a batch, and that of always giving the mean pose."""
        return {**self.losses(windows, labels), "error_of_mean": windows.abs().mean()}


def _convolved(
    channels: int, size: int, *, kernel: int = 3, stride: int = 1, padding: int = 0
) -> tuple[nn.Module, ...]:
    # A bias would be taken off with the mean, and move by rounding alone.
    convolution = nn.Conv1d(channels, size, kernel, stride=stride, padding=padding, bias=False)
    return convolution, nn.BatchNorm1d(size), nn.LeakyReLU(_SLOPE)


def _connected(entries: int, size: int) -> tuple[nn.Module, ...]:
    return nn.Linear(entries, size, bias=False), nn.BatchNorm1d(size), nn.LeakyReLU(_SLOPE)
