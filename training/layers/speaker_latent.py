"""A latent of who speaks, which can be sampled."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor, nn


class SpeakerEncoder(nn.Module):
    """Who speaks, as mean and logarithm of the variance of a latent."""

    def __init__(self, speakers: int, width: int) -> None:
        super().__init__()
        self.embedding = nn.Linear(speakers, width)
        self.mean = nn.Linear(width, width)
        self.variance = nn.Linear(width, width)

    def forward(self, person: Tensor) -> tuple[Tensor, Tensor]:
        """Return both, (B, D_k), of one-hot vectors (B, K)."""
        embedded = self.embedding(person)
        return self.mean(embedded), self.variance(embedded)


def latent_loss(latents: Sequence[tuple[Tensor, Tensor]]) -> Tensor:
    """Return how far the speakers' latents are from normal ones (Kullback & Leibler)."""
    return torch.stack(
        [
            -0.5 * (1 + variance - mean.square() - variance.exp()).mean()
            for mean, variance in latents
        ]
    ).sum()
