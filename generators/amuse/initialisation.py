"""Where AMUSE's networks set out from, so that they learn when something happens.

A frame's values differ by a few hundredths while the learned positions are of the size of 1, and
attention that looks everywhere alike tells the frames of a window apart only after many thousand
steps. So the linear layers at both ends set out from the principal components of the frames, and
attention sets out by looking at what is near in time. The networks and what they can learn stay.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import torch
from torch import Tensor, nn

from generators.amuse.config import PARTS
from generators.amuse.model import Denoiser, MotionPrior
from training.layers.first_weights import (
    LEAST_SPREAD,
    components_of,
    look_near,
    tell_components,
    waves,
)

_SHORTEST: Final = 12
"""Frames of the fastest wave that tells the time."""


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
        weight.div_(heard.std(dim=0).clamp_min(LEAST_SPREAD))
        bias.sub_(weight @ heard.mean(dim=0))


@torch.no_grad()
def set_out(prior: MotionPrior, motion: Tensor) -> None:
    """Set the first weights of a fresh prior from `motion` (windows, frames, motion width).

    Of several tokens' prior, five eighths of the width hold what moves, the rest tells the time;
    one token sets out from the mean alone.
    """
    config, last = prior.config, prior.final_layer
    if config.tokens == 1:
        last.bias.copy_(motion.mean(dim=(0, 1)))
        return
    held = 5 * config.width // 8
    found = components_of(motion.flatten(0, 1), held)
    for layer in (prior.skel_embedding, last):
        layer.weight.zero_()
        layer.bias.zero_()
    tell_components(prior.skel_embedding, found)
    last.weight[:, : len(found.spread)] = found.directions * found.spread
    last.bias.copy_(found.mean)

    def times(count: int) -> Tensor:
        """Return what tells the time of `count` evenly spaced moments of a window."""
        moments = (torch.arange(count) + 0.5) * config.frames / count
        slowest, fastest = math.pi / config.frames, 2 * math.pi / _SHORTEST
        told = waves(moments, slowest, fastest, config.width - held)
        return torch.cat([torch.zeros(count, held), told], dim=1)

    coded = 2 * config.tokens
    prior.query_pos_encoder.pe[coded : coded + config.frames] = times(config.frames)
    prior.query_pos_decoder.pe[: config.frames] = times(config.frames)
    prior.memory_pos.copy_(times(config.tokens))
    prior.query_pos_encoder.pe[:coded] = 0
    prior.global_motion_token.copy_(times(config.tokens).repeat(2, 1))
    prior.global_motion_token[:, :held].normal_(std=0.3)
    for module in prior.modules():
        if isinstance(module, nn.MultiheadAttention):
            look_near(module, held)
