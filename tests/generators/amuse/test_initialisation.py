"""Networks set out from what motion and speech are like."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch
from torch import Tensor

from generators.amuse.config import MOTION_PRESETS
from generators.amuse.model import Denoiser, MotionPrior
from generators.amuse.train import set_out
from training.layers.first_weights import hear_alike

CONFIG = MOTION_PRESETS["tiny"].network


@pytest.fixture(autouse=True)
def _seeded() -> None:
    torch.manual_seed(3)


@pytest.fixture(name="motion")
def _motion() -> Tensor:
    """Windows of motion that has twelve ways to go, around a mean."""
    chance = torch.Generator().manual_seed(1)
    curves = torch.randn(20, CONFIG.frames, 12, generator=chance)
    ways = torch.randn(12, CONFIG.motion_width, generator=chance)
    return 1 + 0.05 * curves @ ways


def test_the_linear_layers_take_frames_apart_and_put_them_together(motion: Tensor) -> None:
    prior = MotionPrior(CONFIG)
    set_out(prior, motion)
    apart = prior.skel_embedding(motion)
    assert (prior.final_layer(apart) - motion).abs().max() < 1e-3
    assert (apart.std(dim=(0, 1))[:12] - 1).abs().max() < 0.05


def test_a_frame_looks_first_at_the_token_of_its_time(motion: Tensor) -> None:
    prior = MotionPrior(CONFIG)
    set_out(prior, motion)
    attention = prior.decoder.get_submodule("input_blocks.0.multihead_attn")
    queries = prior.query_pos_decoder.pe[None, : CONFIG.frames]
    looked = attention(queries, prior.memory_pos[None], prior.memory_pos[None])[1][0]
    nearest = torch.arange(CONFIG.frames) * CONFIG.tokens // CONFIG.frames
    assert (looked.argmax(dim=1) == nearest).float().mean() > 0.9


def test_a_prior_of_one_token_sets_out_from_the_mean(motion: Tensor) -> None:
    prior = MotionPrior(replace(CONFIG, tokens=1))
    before = prior.skel_embedding.weight.clone()
    set_out(prior, motion)
    assert torch.equal(prior.skel_embedding.weight, before)
    assert torch.allclose(prior.final_layer.bias, motion.mean(dim=(0, 1)))


def test_a_denoiser_hears_parts_of_the_speech_alike_however_far_they_spread() -> None:
    denoiser = Denoiser(replace(CONFIG, condition_width=8))
    latents = [0.3 + spread * torch.randn(500, 8) for spread in (1e-2, 1.0, 30.0)]
    told = []
    for part, latent in zip(("content", "emotion", "style"), latents, strict=True):
        layer = denoiser.get_submodule(f"{part}.1")
        hear_alike(layer, latent.relu())
        told.append(layer(latent.relu()))
    spreads = [float(one.std(dim=0).mean().detach()) for one in told]
    assert max(spreads) < 1.5 * min(spreads)
    assert all(float(one.detach().mean(dim=0).abs().max()) < 1 for one in told)
