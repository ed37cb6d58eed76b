"""EMAGE's evaluator, also that of the GENEA leaderboard: convolutions over a skeleton's edges.

The encoder of VAESKConv (Liu et al. 2024, "EMAGE"), after Aberman et al. 2020, "Skeleton-Aware
Networks for Deep Motion Retargeting". Which edges a convolution joins (its mask) and how edges are
pooled are arrays of the published file, so that no skeleton is needed here.
"""

from __future__ import annotations

from typing import Final

import torch
from torch import Tensor, nn

CHANNELS: Final = 330
"""Numbers of a frame: 6D rotations of 55 joints."""

FEATURES: Final = 240

SHRINKS: Final = 16
"""Frames of motion to one row of features."""

TRIMMED_TO: Final = 32
"""The published code drops trailing frames until their number is a multiple of this."""

_LAYERS: Final = ((330, 330, 210), (210, 210, 120), (120, 240, None), (240, 240, None))
"""Channels before and after each layer's convolution, and after its pooling where it pools."""

_GROUPS: Final = 10


class EmageNetwork(nn.Module):
    """Turns motion, shape (n, T, 330), into features, shape (n, T / 16, 240)."""

    def __init__(self) -> None:
        super().__init__()
        layers = (nn.Sequential(_SkeletonResidual(*sizes)) for sizes in _LAYERS)
        self.encoder = nn.ModuleDict({"layers": nn.ModuleList(layers)})

    def forward(self, motion: Tensor) -> Tensor:
        """Return the features; trailing frames past a multiple of 32 are left out."""
        values = motion[:, : motion.shape[1] // TRIMMED_TO * TRIMMED_TO].transpose(1, 2)
        for layer in self.encoder.get_submodule("layers").children():
            values = layer(values)
        return values.transpose(1, 2)


class _SkeletonResidual(nn.Module):
    """Halves the frames, then pools the edges."""

    def __init__(self, entries: int, size: int, pooled: int | None) -> None:
        super().__init__()
        self.residual = nn.Sequential(
            _SkeletonConvolution(entries, size, 4, padding=1), nn.GroupNorm(_GROUPS, size)
        )
        self.shortcut = _SkeletonConvolution(entries, size, 1, padding=0)
        pool = [] if pooled is None else [_SkeletonPool(size, pooled)]
        self.common = nn.Sequential(*pool, nn.Tanh())

    def forward(self, values: Tensor) -> Tensor:
        found: Tensor = self.common(self.residual(values) + self.shortcut(values))
        return found


class _SkeletonConvolution(nn.Module):
    """A convolution over time, of every second frame, with a mask over its weights."""

    def __init__(self, entries: int, size: int, kernel: int, *, padding: int) -> None:
        super().__init__()
        self.mask = nn.Parameter(torch.ones(size, entries, kernel), requires_grad=False)
        self.weight = nn.Parameter(torch.zeros(size, entries, kernel))
        self.bias = nn.Parameter(torch.zeros(size))
        self._padding = padding

    def forward(self, values: Tensor) -> Tensor:
        return nn.functional.conv1d(
            values, self.weight * self.mask, self.bias, stride=2, padding=self._padding
        )


class _SkeletonPool(nn.Module):
    """Mixes edges by a matrix."""

    def __init__(self, entries: int, size: int) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.zeros(size, entries), requires_grad=False)

    def forward(self, values: Tensor) -> Tensor:
        return torch.matmul(self.weight, values)
