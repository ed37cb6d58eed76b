"""What AMUSE's motion networks learn by."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import pytest
import torch

from generators.amuse.losses import (
    OF_ALIGNMENT,
    OF_PRIOR,
    LossWeights,
    motion_losses,
)
from generators.amuse.model import MotionModel
from tests.generators.amuse.small_networks import MOTION

SMALL = replace(MOTION, frames=12)
DENOISER_ALONE = LossWeights().without(*OF_PRIOR, *OF_ALIGNMENT)


@pytest.fixture(name="model")
def _model() -> MotionModel:
    torch.manual_seed(5)
    return MotionModel(SMALL).eval()


def _losses(model: MotionModel, weights: LossWeights) -> dict[str, torch.Tensor]:
    random = torch.Generator().manual_seed(2)
    motion = torch.randn(2, 12, 333, generator=random)
    latents = [torch.randn(2, 1, 8, generator=random) for _ in range(3)]
    noise = torch.randn(4, 2, 1, SMALL.width, generator=random)
    return motion_losses(model, motion, latents, noise, torch.tensor([[3, 700], [0, 500]]), weights)


def _taught(model: MotionModel, weights: LossWeights) -> set[str]:
    """Which networks get a gradient of the loss."""
    model.zero_grad()
    _losses(model, weights)["loss"].backward()
    parts = {
        "encoder": model.prior.encoder,
        "decoder": model.prior.decoder,
        "denoiser": model.denoiser,
    }
    return {
        name
        for name, part in parts.items()
        if any(weight.grad is not None and weight.grad.any() for weight in part.parameters())
    }


_NOTHING = LossWeights(rec=0, vrec=0, kl=0, ld=0, align=0, valign=0)


@pytest.mark.parametrize(
    ("name", "taught"),
    [
        ("rec", {"encoder", "decoder"}),
        ("vrec", {"encoder", "decoder"}),
        ("velocity", {"encoder", "decoder"}),
        ("kl", {"encoder"}),
        ("ld", {"denoiser"}),
        ("align", {"decoder"}),
        ("valign", {"decoder"}),
    ],
)
def test_each_loss_teaches_the_networks_that_the_paper_says(
    model: MotionModel, name: str, taught: set[str]
) -> None:
    assert _taught(model, replace(_NOTHING, **{name: 1.0})) == taught


def test_the_loss_is_the_weighted_sum_of_its_parts(model: MotionModel) -> None:
    weights = LossWeights(rec=2, vrec=3, kl=1e-4, ld=5, align=0.5, valign=0.25, velocity=0.1)
    losses = {name: float(value.detach()) for name, value in _losses(model, weights).items()}
    parts = sum(getattr(weights, name) * losses[name] for name in losses if name != "loss")
    assert losses["loss"] == pytest.approx(parts, rel=1e-5)


def test_the_latents_distance_is_that_of_two_normal_laws(model: MotionModel) -> None:
    motion = torch.randn(2, 12, 333, generator=torch.Generator().manual_seed(2))
    mu, std = model.prior.encode(motion)
    found = torch.distributions.kl_divergence(
        torch.distributions.Normal(mu, std), torch.distributions.Normal(0.0, 1.0)
    )
    assert float(_losses(model, LossWeights())["kl"].detach()) == pytest.approx(
        float(found.mean().detach()), rel=1e-5
    )


def test_losses_that_count_nothing_are_not_computed(model: MotionModel) -> None:
    weights = LossWeights(velocity=0.1)
    prior = {"loss", "kl", "rec", "vrec", "velocity"}
    assert set(_losses(model, weights.without(*OF_ALIGNMENT))) == {*prior, "ld"}
    assert set(_losses(model, weights.without("ld", *OF_ALIGNMENT))) == prior
    assert set(_losses(model, DENOISER_ALONE)) == {"loss", "ld"}


@pytest.mark.parametrize("predicts", ["eps", "v"])
@torch.inference_mode()
def test_each_draw_of_noise_counts_alike(predicts: Literal["eps", "v"]) -> None:
    torch.manual_seed(5)
    model = MotionModel(replace(SMALL, predicts=predicts)).eval()
    random = torch.Generator().manual_seed(2)
    motion = torch.randn(2, 12, 333, generator=random)
    latents = [torch.randn(2, 1, 8, generator=random) for _ in range(3)]
    noise = torch.randn(4, 2, 1, SMALL.width, generator=random)
    steps = torch.tensor([[3, 700], [0, 500]])
    alone = [
        motion_losses(
            model, motion, latents, noise[[0, 1, draw + 2]], steps[[draw]], DENOISER_ALONE
        )
        for draw in range(2)
    ]
    together = motion_losses(model, motion, latents, noise, steps, DENOISER_ALONE)
    assert float(together["ld"]) == pytest.approx(sum(float(one["ld"]) for one in alone) / 2)
