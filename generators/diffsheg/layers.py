"""The layers of DiffSHEG's transformers.

Diffusion step and speaker act on them through *modulations*: a scale and a shift for each channel
that depend on nothing else. They are handed in, so that who denoises many windows with the same
steps computes them once.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn
from torch.nn import functional


class Stylization(nn.Module):
    """Scales and shifts normalised features, and maps them on (AdaIN, section 3.3).

    The map starts at zero, so that an untrained block changes nothing.
    """

    def __init__(self, width: int, style_width: int, dropout: float) -> None:
        super().__init__()
        self.modulation = nn.Linear(style_width, 2 * width)
        self.norm = nn.LayerNorm(width)
        self.dropout = nn.Dropout(dropout)
        self.out = zeroed(nn.Linear(width, width))

    def modulate(self, style: Tensor) -> Tensor:
        """Return scale and shift, (batch, 1, 2 · width), of activated `style` (batch, style)."""
        modulation: Tensor = self.modulation(style)
        return modulation.unsqueeze(1)

    def forward(self, features: Tensor, modulation: Tensor) -> Tensor:
        """Return (batch, frames, width)."""
        scale, shift = modulation.chunk(2, dim=-1)
        styled = self.norm(features) * (1 + scale) + shift
        result: Tensor = self.out(self.dropout(functional.silu(styled)))
        return result


class LinearAttention(nn.Module):
    """Self-attention whose cost grows with the number of frames, not with its square.

    Shen et al. 2021, "Efficient attention": queries are normalised over channels, keys over
    frames.
    """

    def __init__(self, width: int, heads: int, style_width: int, dropout: float) -> None:
        super().__init__()
        self.heads = heads
        self.norm = nn.LayerNorm(width)
        self.query = nn.Linear(width, width)
        self.key = nn.Linear(width, width)
        self.value = nn.Linear(width, width)
        self.stylization = Stylization(width, style_width, dropout)

    def forward(self, features: Tensor, modulation: Tensor) -> Tensor:
        """Return (batch, frames, width)."""
        normed = self.norm(features)
        split = (*normed.shape[:2], self.heads, -1)
        query = self.query(normed).view(split).softmax(dim=-1)
        key = self.key(normed).view(split).softmax(dim=1)
        value = self.value(normed).view(split)
        context = torch.einsum("bnhd,bnhl->bhdl", key, value)
        attended = torch.einsum("bnhd,bhdl->bnhl", query, context).reshape(features.shape)
        result: Tensor = features + self.stylization(attended, modulation)
        return result


class FeedForward(nn.Module):
    """The two maps after the attention."""

    def __init__(self, width: int, inner: int, style_width: int, dropout: float) -> None:
        super().__init__()
        self.widen = nn.Linear(width, inner)
        self.dropout = nn.Dropout(dropout)
        self.narrow = zeroed(nn.Linear(inner, width))
        self.stylization = Stylization(width, style_width, dropout)

    def forward(self, features: Tensor, modulation: Tensor) -> Tensor:
        """Return (batch, frames, width)."""
        inner = self.narrow(self.dropout(functional.gelu(self.widen(features))))
        result: Tensor = features + self.stylization(inner, modulation)
        return result


class StyledBlock(nn.Module):
    """The style-aware transformer block: attention, then the two maps, each stylised."""

    def __init__(
        self, width: int, inner: int, heads: int, style_width: int, dropout: float
    ) -> None:
        super().__init__()
        self.attention = LinearAttention(width, heads, style_width, dropout)
        self.feed_forward = FeedForward(width, inner, style_width, dropout)

    def modulate(self, style: Tensor) -> Tensor:
        """Return both modulations of activated `style`, (batch, 1, 4 · width)."""
        return torch.cat(
            [
                self.attention.stylization.modulate(style),
                self.feed_forward.stylization.modulate(style),
            ],
            dim=-1,
        )

    def forward(self, features: Tensor, modulation: Tensor) -> Tensor:
        """Return (batch, frames, width)."""
        first, second = modulation.chunk(2, dim=-1)
        result: Tensor = self.feed_forward(self.attention(features, first), second)
        return result


class Fusion(nn.Module):
    """The motion-speech fusion residual block: tells the features of a motion its conditions."""

    def __init__(self, width: int, conditions: int) -> None:
        super().__init__()
        self.norm = nn.LayerNorm(width + conditions)
        self.widen = nn.Linear(width + conditions, 2 * width)
        self.narrow = nn.Linear(2 * width, width)

    def forward(self, features: Tensor, together: Tensor) -> Tensor:
        """Return (batch, frames, width) of features, and of features and conditions `together`."""
        inner = functional.silu(self.widen(self.norm(together)))
        result: Tensor = features + self.narrow(inner)
        return result


class Embedding(nn.Module):
    """Two maps that turn what holds for a whole window into a style."""

    def __init__(self, width: int, style_width: int) -> None:
        super().__init__()
        self.first = nn.Linear(width, style_width)
        self.second = nn.Linear(style_width, style_width)

    def forward(self, value: Tensor) -> Tensor:
        """Return (batch, style width)."""
        result: Tensor = self.second(functional.silu(self.first(value)))
        return result


class SpeechEncoder(nn.Module):
    """Two convolutions over time that narrow speech features, one pair for each branch."""

    def __init__(self, features: int, width: int) -> None:
        super().__init__()
        self.first = nn.Conv1d(features, width, 3, padding=1, bias=False)
        self.norm = nn.BatchNorm1d(width)
        self.second = nn.Conv1d(width, width, 3, padding=1, bias=False)

    def forward(self, features: Tensor) -> Tensor:
        """Return (batch, frames, width) of (batch, frames, features)."""
        inner = functional.gelu(self.norm(self.first(features.transpose(1, 2))))
        result: Tensor = self.second(inner).transpose(1, 2)
        return result


def step_features(steps: Tensor, width: int) -> Tensor:
    """Return cosines and sines of diffusion steps, (batch, width).

    Frequencies fall from 1 to 1/10000 (Vaswani et al. 2017, section 3.5).
    """
    half = width // 2
    falling = torch.arange(half, dtype=torch.float32, device=steps.device) / half
    angles = steps[:, None].float() * torch.exp(-math.log(10_000) * falling)
    return torch.cat([angles.cos(), angles.sin()], dim=-1)


def positions(longest: int, width: int) -> Tensor:
    """Return sines and cosines of each frame's place, (1, longest, width), taking turns."""
    place = torch.arange(longest, dtype=torch.float32)[:, None]
    falling = torch.arange(0, width, 2, dtype=torch.float32) / width
    angles = place * torch.exp(-math.log(10_000) * falling)
    return torch.stack([angles.sin(), angles.cos()], dim=-1).reshape(1, longest, width)


def zeroed(layer: nn.Linear) -> nn.Linear:
    """Return `layer` with all its weights at zero."""
    nn.init.zeros_(layer.weight)
    nn.init.zeros_(layer.bias)
    return layer
