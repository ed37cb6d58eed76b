"""Convolutions over time, and motion that is decoded by them."""

from __future__ import annotations

from torch import Tensor, nn


def over_time(width_in: int, width: int, kernel: int, dilation: int = 1) -> nn.Sequential:
    """Return a convolution over time, (B, C, T) to (B, width, T), normalised."""
    padding = kernel // 2 * dilation
    return nn.Sequential(
        nn.Conv1d(width_in, width, kernel, padding=padding, dilation=dilation),
        nn.BatchNorm1d(width),
        nn.LeakyReLU(0.1),
    )


class Decoder(nn.Module):
    """Motion of an embedding: convolutions over time and over features, then all together."""

    def __init__(self, width: int, hidden: int, values: int) -> None:
        super().__init__()
        self.temporal = nn.Sequential(over_time(width, hidden, 5), over_time(hidden, hidden, 5))
        self.spatial = nn.Sequential(
            nn.Conv1d(1, 4, 5, padding=2), nn.LeakyReLU(0.1), nn.Conv1d(4, 1, 5, padding=2)
        )
        self.full = nn.Sequential(
            nn.Linear(hidden, 2 * hidden), nn.LeakyReLU(0.1), nn.Linear(2 * hidden, values)
        )

    def forward(self, embedding: Tensor) -> Tensor:
        """Return (B, T, values) of (B, T, H)."""
        over_time = self.temporal(embedding.transpose(1, 2)).transpose(1, 2)
        batch, frames, width = over_time.shape
        over_features = self.spatial(over_time.reshape(batch * frames, 1, width))
        found: Tensor = self.full(over_time + over_features.reshape(batch, frames, width))
        return found
