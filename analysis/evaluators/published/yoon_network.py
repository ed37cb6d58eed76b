"""The encoder of Yoon et al. 2020 for TED Gesture, which BEAT (Liu et al. 2022) made larger.

"Speech Gesture Generation from the Trimodal Context of Text, Audio, and Speaker Identity".
"""

from __future__ import annotations

from typing import Final

from torch import Tensor, nn

WINDOW: Final = 34

_LEFT: Final = 12
"""Frames of a window that are left after the convolutions."""

_SLOPE: Final = 0.2
"""Of the leaky rectifiers between convolutions."""

_WRITTEN_AS_TRUE: Final = 1.0
"""Of those between full layers: published as ``LeakyReLU(True)``, whose slope is 1."""


class YoonNetwork(nn.Module):
    """Turns windows of motion, shape (n, 34, channels), into vectors, shape (n, features).

    Parameters
    ----------
    channels : int
        Numbers of a frame.
    convolved : tuple of int
        Channels after each of the four convolutions.
    connected : tuple of int
        Sizes of the full layers; the last is that of the features.
    """

    def __init__(
        self, channels: int, convolved: tuple[int, int, int, int], connected: tuple[int, int, int]
    ) -> None:
        super().__init__()
        self.pose_encoder = _PoseEncoder(channels, convolved, connected)

    def forward(self, windows: Tensor) -> Tensor:
        """Return the mean of the latent distribution, which is the published feature."""
        found: Tensor = self.pose_encoder(windows)
        return found


class _PoseEncoder(nn.Module):
    def __init__(
        self, channels: int, convolved: tuple[int, int, int, int], connected: tuple[int, int, int]
    ) -> None:
        super().__init__()
        first, second, third, last = convolved
        wide, narrow, features = connected
        self.net = nn.Sequential(
            _convolved(channels, first, 3, 1),
            _convolved(first, second, 3, 1),
            _convolved(second, third, 4, 2),
            nn.Conv1d(third, last, 3),
        )
        self.out_net = nn.Sequential(
            *_connected(last * _LEFT, wide), *_connected(wide, narrow), nn.Linear(narrow, features)
        )
        self.fc_mu = nn.Linear(features, features)

    def forward(self, windows: Tensor) -> Tensor:
        convolved = self.net(windows.transpose(1, 2))
        found: Tensor = self.fc_mu(self.out_net(convolved.flatten(1)))
        return found


def _convolved(entries: int, size: int, kernel: int, stride: int) -> nn.Sequential:
    convolution = nn.Conv1d(entries, size, kernel, stride=stride)
    return nn.Sequential(convolution, nn.BatchNorm1d(size), nn.LeakyReLU(_SLOPE))


def _connected(entries: int, size: int) -> tuple[nn.Module, ...]:
    return nn.Linear(entries, size), nn.BatchNorm1d(size), nn.LeakyReLU(_WRITTEN_AS_TRUE)
