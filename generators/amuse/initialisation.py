"""Where AMUSE's networks set out from, so that they learn when something happens.

A frame's values differ by a few hundredths while the learned positions are of the size of 1, and
attention that looks everywhere alike tells the frames of a window apart only after many thousand
steps. So the linear layers at both ends set out from the principal components of the frames, and
attention sets out by looking at what is near in time. Encoders of speech set out from the
principal components of the patches, each as large as the next, so that the height of a voice counts
beside its loudness; and from waves that tell a patch's time and pitch, without which the mean over
patches forgets both. The networks and what they can learn stay.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import torch
from torch import Tensor, nn

from generators.amuse.config import PARTS
from generators.amuse.model import Denoiser, MotionPrior
from generators.amuse.speech import SpeechEncoder

_SHORTEST: Final = 12
"""Frames of the fastest wave that tells the time."""

_SHARPNESS: Final = 3.0
"""How much more attention is paid to what is near in time."""

_LEAST_SPREAD: Final = 1e-3
"""Of a principal component, or of what is heard; smaller ones are rounding."""

_COMPONENTS: Final = 64
"""Principal components of a patch that an encoder hears at first; smaller ones are noise."""

_SIZE: Final = 0.5
"""Of a patch's components, and of the waves that tell its place."""


@torch.no_grad()
def listen(encoder: SpeechEncoder, filterbanks: Tensor) -> None:
    """Set the layers that a fresh encoder hears by.

    Parameters
    ----------
    encoder : SpeechEncoder
        Fresh.
    filterbanks : Tensor
        (windows, frames, bands), what it is to hear.
    """
    first = encoder.transformer.embeddings.patch_embeddings.projection
    size = first.kernel_size[0]
    patches = (
        filterbanks.unfold(1, size, size).unfold(2, size, size).transpose(3, 4).reshape(-1, size**2)
    )
    mean = patches.mean(dim=0)
    count = min(_COMPONENTS, len(first.weight))
    components = torch.pca_lowrank(patches, q=count, niter=4)[2]
    spread = ((patches - mean) @ components).std(dim=0).clamp_min(_LEAST_SPREAD)
    rows = _SIZE * (components / spread).T
    first.weight[:count] = rows.view(count, 1, size, size)
    first.bias[:count] = -rows @ mean
    _place_patches(encoder)


def _place_patches(encoder: SpeechEncoder) -> None:
    """Let the positions of an encoder tell the time and the pitch of its patches."""
    embeddings = encoder.transformer.embeddings
    positions = embeddings.position_embeddings
    bands, rows = embeddings.get_shape(embeddings.config)
    half = positions.shape[-1] // 2
    pitch, time = (
        _waves(torch.arange(count), math.pi / count, math.pi, half) for count in (bands, rows)
    )
    places = torch.cat(
        [time.expand(bands, -1, -1), pitch[:, None].expand(-1, rows, -1)], dim=-1
    ).flatten(0, 1)
    positions[0, -len(places) :] = _SIZE * places


@torch.no_grad()
def hear(denoiser: Denoiser, latents: Sequence[Tensor]) -> None:
    """Set the layers that a fresh denoiser hears by, so that all parts of the speech count alike.

    Parameters
    ----------
    denoiser : Denoiser
        Fresh.
    latents : sequence of Tensor
        Content, emotion and style, (windows, condition width) each.
    """
    for part, latent in zip(PARTS, latents, strict=False):
        weight, bias = (denoiser.get_parameter(f"{part}.1.{name}") for name in ("weight", "bias"))
        heard = latent.relu()
        weight.div_(heard.std(dim=0).clamp_min(_LEAST_SPREAD))
        bias.sub_(weight @ heard.mean(dim=0))


@torch.no_grad()
def set_out(prior: MotionPrior, motion: Tensor) -> None:
    """Set the first weights of a fresh prior from `motion` (windows, frames, motion width).

    Of several tokens' prior, five eighths of the width hold what moves, the rest tells the time;
    one token sets out from the mean alone.
    """
    config = prior.config
    if config.tokens == 1:
        prior.final_layer.bias.copy_(motion.mean(dim=(0, 1)))
        return
    held = 5 * config.width // 8
    _code_frames(prior, motion.flatten(0, 1), held)
    for positions, first in (
        (prior.query_pos_encoder, 2 * config.tokens),
        (prior.query_pos_decoder, 0),
    ):
        positions.pe[first : first + config.frames] = _times(
            config.frames, config.frames, config.width - held, held
        )
    tokens = _times(config.tokens, config.frames, config.width - held, held)
    prior.memory_pos.copy_(tokens)
    prior.query_pos_encoder.pe[: 2 * config.tokens] = 0
    prior.global_motion_token.copy_(tokens.repeat(2, 1))
    prior.global_motion_token[:, :held].normal_(std=0.3)
    for layer in prior.modules():
        if isinstance(layer, nn.MultiheadAttention):
            _look_near(layer, held)


def _code_frames(prior: MotionPrior, frames: Tensor, held: int) -> None:
    """Let the linear layers take frames apart into principal components, and put them together."""
    mean = frames.mean(dim=0)
    components = torch.pca_lowrank(frames, q=min(held, *frames.shape), niter=4)[2]
    spread = ((frames - mean) @ components).std(dim=0).clamp_min(_LEAST_SPREAD)
    count = len(spread)
    first, last = prior.skel_embedding, prior.final_layer
    for layer in (first, last):
        layer.weight.zero_()
        layer.bias.zero_()
    first.weight[:count] = (components / spread).T
    first.bias[:count] = -first.weight[:count] @ mean
    last.weight[:, :count] = components * spread
    last.bias.copy_(mean)


def _times(count: int, frames: int, waves: int, before: int) -> Tensor:
    """Return what tells the time of `count` evenly spaced moments of a window."""
    moments = (torch.arange(count) + 0.5) * frames / count
    told = _waves(moments, math.pi / frames, 2 * math.pi / _SHORTEST, waves)
    return torch.cat([torch.zeros(count, before), told], dim=1)


def _waves(places: Tensor, slowest: float, fastest: float, width: int) -> Tensor:
    """Return sines and cosines (places, width) of `places`, from slow to fast, radians for 1."""
    turns = torch.logspace(math.log10(slowest), math.log10(fastest), width // 2)
    angles = places[:, None] * turns
    return torch.cat([angles.sin(), angles.cos()], dim=1)


def _look_near(attention: nn.MultiheadAttention, held: int) -> None:
    """Let each head compare times, in other waves each, and hardly what moves."""
    width, size = attention.embed_dim, attention.head_dim
    for head in range(attention.num_heads):
        waves = torch.linalg.qr(torch.randn(width - held, width - held)).Q[:size]
        for part in (0, width):
            rows = slice(part + head * size, part + head * size + len(waves))
            attention.in_proj_weight[rows] *= 0.3
            attention.in_proj_weight[rows, held:] = _SHARPNESS * waves
