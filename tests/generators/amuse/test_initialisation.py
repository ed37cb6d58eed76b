"""Networks are initialised from statistics of motion and speech."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch
from torch import Tensor

from generators.amuse.config import MOTION_PRESETS
from generators.amuse.model import MotionPrior
from generators.amuse.train import initialise_prior

CONFIG = MOTION_PRESETS["tiny"].network


@pytest.fixture(autouse=True)
def _seeded() -> None:
    torch.manual_seed(3)


@pytest.fixture(name="motion")
def _motion() -> Tensor:
    """Windows of motion with twelve principal components around a mean."""
    chance = torch.Generator().manual_seed(1)
    curves = torch.randn(20, CONFIG.frames, 12, generator=chance)
    ways = torch.randn(12, CONFIG.motion_width, generator=chance)
    return 1 + 0.05 * curves @ ways


def test_the_linear_layers_take_frames_apart_and_put_them_together(motion: Tensor) -> None:
    prior = MotionPrior(CONFIG)
    initialise_prior(prior, motion)
    apart = prior.skel_embedding(motion)
    assert (prior.final_layer(apart) - motion).abs().max() < 1e-3
    assert (apart.std(dim=(0, 1))[:12] - 1).abs().max() < 0.05


def test_a_prior_of_one_token_sets_out_from_the_mean(motion: Tensor) -> None:
    prior = MotionPrior(replace(CONFIG, tokens=1))
    before = prior.skel_embedding.weight.clone()
    initialise_prior(prior, motion)
    assert torch.equal(prior.skel_embedding.weight, before)
    assert torch.allclose(prior.final_layer.bias, motion.mean(dim=(0, 1)))
