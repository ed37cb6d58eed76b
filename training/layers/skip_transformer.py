"""A transformer with skips, after Bao et al. 2023 (U-ViT) and Chen et al. 2023 (MLD)."""

from __future__ import annotations

import torch
from torch import Tensor, nn


class SkipTransformer(nn.Module):
    """Transformer layers of which the first half is told to the second, as in a U-Net.

    Parameters
    ----------
    width, feed_forward, heads, layers : int
        Sizes; `layers` is odd.
    dropout : float
        While training.
    reads_memory : bool
        Whether each layer also attends to a memory.
    """

    def __init__(
        self,
        *,
        width: int,
        feed_forward: int,
        heads: int,
        layers: int,
        dropout: float,
        reads_memory: bool = False,
    ) -> None:
        super().__init__()
        kind = nn.TransformerDecoderLayer if reads_memory else nn.TransformerEncoderLayer

        def blocks(count: int) -> nn.ModuleList:
            sizes = (width, heads, feed_forward, dropout)
            return nn.ModuleList(
                kind(*sizes, activation="gelu", batch_first=True) for _ in range(count)
            )

        half = layers // 2
        self.input_blocks = blocks(half)
        self.middle_block = blocks(1)[0]
        self.output_blocks = blocks(half)
        self.linear_blocks = nn.ModuleList(nn.Linear(2 * width, width) for _ in range(half))
        self.norm = nn.LayerNorm(width)

    def forward(self, x: Tensor, *memory: Tensor) -> Tensor:
        """Return the sequence `x` (batch, tokens, width), transformed."""
        told = []
        for block in self.input_blocks:
            x = block(x, *memory)
            told.append(x)
        x = self.middle_block(x, *memory)
        for linear, block in zip(self.linear_blocks, self.output_blocks, strict=True):
            x = block(linear(torch.cat([x, told.pop()], dim=-1)), *memory)
        normalised: Tensor = self.norm(x)
        return normalised
