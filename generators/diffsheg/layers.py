"""The layers of DiffSHEG's transformers, in the order in which the network uses them."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from functools import cache
from typing import NamedTuple

import numpy as np
import torch
from scipy.fft import dct
from torch import Tensor, nn
from torch.nn import functional

from motion.arrays import Floats, Floats32
from training.diffusion import LINEAR
from training.layers.interpolation import interpolate_features


def zeroed(layer: nn.Linear) -> nn.Linear:
    """Set all weights of `layer` to zero and return it."""
    nn.init.zeros_(layer.weight)
    nn.init.zeros_(layer.bias)
    return layer


class Embedding(nn.Module):
    """Two linear layers that embed a diffusion step or a speaker as a style."""

    def __init__(self, width: int, style_width: int) -> None:
        super().__init__()
        self.first = nn.Linear(width, style_width)
        self.second = nn.Linear(style_width, style_width)

    def forward(self, value: Tensor) -> Tensor:
        """Return (batch, style width)."""
        result: Tensor = self.second(functional.silu(self.first(value)))
        return result


class Stylization(nn.Module):
    """Scales and shifts normalised features by a style (AdaIN, section 3.3), then a linear layer.

    Scale and shift, the *modulation*, depend on the diffusion step and the speaker only. The linear
    layer starts at zero, so an untrained block changes nothing.
    """

    def __init__(self, width: int, style_width: int, dropout: float) -> None:
        super().__init__()
        self.modulation = nn.Linear(style_width, 2 * width)
        self.norm = nn.LayerNorm(width)
        self.dropout = nn.Dropout(dropout)
        self.out = zeroed(nn.Linear(width, width))

    def forward(self, h: Tensor, modulation: Tensor) -> Tensor:
        """Return (batch, frames, width), given a modulation (batch, 1, 2 · width)."""
        scale, shift = modulation.chunk(2, dim=-1)
        styled = self.norm(h) * (1 + scale) + shift
        result: Tensor = self.out(self.dropout(functional.silu(styled)))
        return result


class LinearAttention(nn.Module):
    """Self-attention whose cost is linear in the number of frames, not quadratic.

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

    def forward(self, h: Tensor, modulation: Tensor) -> Tensor:
        """Return (batch, frames, width)."""
        normed = self.norm(h)
        split = (*normed.shape[:2], self.heads, -1)
        query = self.query(normed).view(split).softmax(dim=-1).transpose(1, 2)
        key = self.key(normed).view(split).softmax(dim=1).permute(0, 2, 3, 1)
        value = self.value(normed).view(split).transpose(1, 2)
        attended = (query @ (key @ value)).transpose(1, 2).reshape(h.shape)
        result: Tensor = h + self.stylization(attended, modulation)
        return result


class FeedForward(nn.Module):
    """The two linear layers after the attention."""

    def __init__(self, width: int, inner: int, style_width: int, dropout: float) -> None:
        super().__init__()
        self.widen = nn.Linear(width, inner)
        self.dropout = nn.Dropout(dropout)
        self.narrow = zeroed(nn.Linear(inner, width))
        self.stylization = Stylization(width, style_width, dropout)

    def forward(self, h: Tensor, modulation: Tensor) -> Tensor:
        """Return (batch, frames, width)."""
        inner = self.narrow(self.dropout(functional.gelu(self.widen(h))))
        result: Tensor = h + self.stylization(inner, modulation)
        return result


class StyledBlock(nn.Module):
    """The style-aware transformer block: attention and feed-forward, each stylised."""

    def __init__(
        self, width: int, inner: int, heads: int, style_width: int, dropout: float
    ) -> None:
        super().__init__()
        self.attention = LinearAttention(width, heads, style_width, dropout)
        self.feed_forward = FeedForward(width, inner, style_width, dropout)

    def modulate(self, style: Tensor) -> Tensor:
        """Return both modulations of `style` (batch, style width), (batch, 1, 4 · width)."""
        stylizations = (self.attention.stylization, self.feed_forward.stylization)
        return torch.cat([s.modulation(style) for s in stylizations], dim=-1).unsqueeze(1)

    def forward(self, h: Tensor, modulation: Tensor) -> Tensor:
        """Return (batch, frames, width)."""
        first, second = modulation.chunk(2, dim=-1)
        result: Tensor = self.feed_forward(self.attention(h, first), second)
        return result


class FusedSpeech(NamedTuple):
    """The part of a `Fusion` that depends on the speech only.

    Attributes
    ----------
    mapped : Tensor
        (batch, frames, 2 · width), the first layer applied to the speech.
    sums : Tensor
        (batch, frames, 2), sums of the speech's values and of their squares.
    ones, bias : Tensor
        (2 · width,), the first layer applied to the norm's weight and to its bias.
    """

    mapped: Tensor
    sums: Tensor
    ones: Tensor
    bias: Tensor

    def rows(self, rows: slice) -> FusedSpeech:
        """Return some rows of the batch."""
        return self._replace(mapped=self.mapped[rows], sums=self.sums[rows])


class Fusion(nn.Module):
    """The motion–speech fusion block: h + MLP(norm([h, speech, x̂0])).

    The norm is split so that the part of the speech is computed once while the motion changes. With
    γ and β the norm's weight and bias, W the first layer, and m and s the mean and the standard
    deviation of all values of v = [h, speech, x̂0]::

        W norm(v) = (W_h γ_h h + W_s γ_s speech + W_x γ_x x̂0 - m W γ) / s + W β
    """

    def __init__(self, width: int, conditions: int) -> None:
        super().__init__()
        self.norm = nn.LayerNorm(width + conditions)
        self.widen = nn.Linear(width + conditions, 2 * width)
        self.narrow = nn.Linear(2 * width, width)
        self.width = width

    def fuse(self, speech: Tensor) -> FusedSpeech:
        """Return the part of the fusion that depends on the speech (batch, frames, channels)."""
        return FusedSpeech(
            self._map(speech, self.width),
            _sums(speech),
            self.widen.weight @ self.norm.weight,
            self.widen(self.norm.bias),
        )

    def forward(self, h: Tensor, speech: FusedSpeech, x0_hat: Tensor | None = None) -> Tensor:
        """Return the term added to h, (batch, frames, width)."""
        inner, sums = self._map(h, 0) + speech.mapped, _sums(h) + speech.sums
        if x0_hat is not None:
            inner = inner + self._map(x0_hat, len(self.norm.weight) - x0_hat.shape[-1])
            sums = sums + _sums(x0_hat)
        mean, square = (sums / len(self.norm.weight)).chunk(2, dim=-1)
        scale = torch.rsqrt(square - mean.square() + self.norm.eps)
        return self._narrow((inner - mean * speech.ones) * scale + speech.bias)

    def unconditioned(self, null: Tensor) -> Tensor:
        """Return the term added for the learned vector `null` instead of v, (1, width)."""
        return self._narrow(self.widen(self.norm(null)))

    def _map(self, values: Tensor, first: int) -> Tensor:
        """Apply the first layer to `values`, which are those of v from `first` on."""
        columns = slice(first, first + values.shape[-1])
        return functional.linear(values * self.norm.weight[columns], self.widen.weight[:, columns])

    def _narrow(self, inner: Tensor) -> Tensor:
        result: Tensor = self.narrow(functional.silu(inner))
        return result


def _sums(values: Tensor) -> Tensor:
    """Return the sums of values (batch, frames, width) and of their squares, (batch, frames, 2)."""
    values = values.float()
    return torch.stack([values.sum(dim=-1), values.square().sum(dim=-1)], dim=-1)


class SpeechEncoder(nn.Module):
    """Two convolutions over time that narrow HuBERT's features; each branch has its own pair."""

    def __init__(self, features: int, width: int) -> None:
        super().__init__()
        self.first = nn.Conv1d(features, width, 3, padding=1, bias=False)
        self.norm = nn.BatchNorm1d(width)
        self.second = nn.Conv1d(width, width, 3, padding=1, bias=False)

    def forward(self, hubert: Tensor) -> Tensor:
        """Return the encoding (batch, frames, width) of features (batch, frames, features)."""
        inner = functional.gelu(self.norm(self.first(hubert.transpose(1, 2))))
        result: Tensor = self.second(inner).transpose(1, 2)
        return result


class LinearSkip(nn.Module):
    """Adds the best linear estimate of the noise to the output of the layers, which it bypasses.

    Motion is decomposed into waves of poses: principal components of poses, and cosines in time
    (DCT-II). From each wave's variance follows the share of noise in it (Wiener 1949). A wave that
    no motion has is all noise, which layers narrower than a pose need not carry. Before `fit`,
    every wave has the variance of a normalised value, 1.

    The remainder is the layers' output times √ᾱ. With variances of 1, that output is the velocity
    of Salimans & Ho 2022. The resulting clean motion differs from its linear estimate by √(1 - ᾱ)
    times the output, at no step by more than the output.

    Parameters
    ----------
    frames : int
        Frames of the training windows.
    part : int
        Number of values of a frame.
    """

    directions: Tensor
    variances: Tensor

    def __init__(self, frames: int, part: int) -> None:
        super().__init__()
        self.register_buffer("directions", torch.eye(part))
        self.register_buffer("variances", torch.ones(frames, part))

    def fit(self, windows: Floats32) -> None:
        """Estimate the variances from normalised motion, (windows, frames, part)."""
        frames, part = windows.shape[1:]
        poses = windows.reshape(-1, part).astype(np.float64)
        _, directions = np.linalg.eigh(poses.T @ poses / len(poses))
        waves = _cosines(frames) @ (windows @ directions)
        self.directions.copy_(torch.from_numpy(directions))
        self.variances.copy_(torch.from_numpy(np.square(waves).mean(axis=0)))

    def forward(self, output: Tensor, noisy: Tensor, steps: Tensor) -> Tensor:
        """Return the noise in `noisy`, given the layers' `output`.

        Parameters
        ----------
        output, noisy : Tensor
            (batch, frames, part); there may be fewer frames than in a window.
        steps : Tensor
            (batch,) or (1,) diffusion steps.
        """
        # If most is signal, noise is a small difference, for which half precision is too coarse.
        with _full_precision(noisy.device.type):
            noisy = noisy.float()
            alpha = LINEAR.alpha_bar_at(steps, noisy)
            cosines = torch.as_tensor(
                _cosines(noisy.shape[1]), dtype=torch.float32, device=noisy.device
            )
            shares = (1 - alpha).sqrt() / (alpha * self._variances(noisy.shape[1]) + (1 - alpha))
            waves = cosines @ (noisy @ self.directions)
            linear = (cosines.T @ (shares * waves)) @ self.directions.T
            return linear + alpha.sqrt() * output.float()

    def _variances(self, frames: int) -> Tensor:
        """Return the variances of the waves of `frames` frames, interpolated by frequency."""
        full = len(self.variances)
        if frames == full:
            return self.variances
        places = torch.arange(frames, device=self.variances.device) * (full / frames)
        return interpolate_features(self.variances, places)


def _full_precision(device: str) -> AbstractContextManager[object]:
    """Turn off torch's autocast, which the meta device does not have."""
    return nullcontext() if device == "meta" else torch.autocast(device, enabled=False)


@cache
def _cosines(frames: int) -> Floats:
    """Return the matrix of the orthonormal DCT-II, (waves, frames)."""
    return np.asarray(dct(np.eye(frames), norm="ortho", axis=0))
