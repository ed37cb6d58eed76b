"""AMUSE's losses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

import pytest
import torch

from generators.amuse.losses import (
    MOTION_LOSSES,
    OTHER_CONTENT,
    OTHER_STYLE,
    SPEECH_LOSSES,
    motion_losses,
    speech_losses,
    without,
)
from generators.amuse.model import MotionModel
from generators.amuse.speech import SpeechModel
from tests.generators.amuse.small_networks import MOTION
from tests.generators.amuse.test_speech import SMALL as SPEECH

SMALL = replace(MOTION, frames=12)
CLASSES = torch.tensor([[0, 0, 0, 0], [0, 0, 1, 1]])
"""Emotions and speakers of a quadruple."""
DENOISER_ALONE = without(MOTION_LOSSES, "denoiser")


@pytest.fixture(name="model")
def _model() -> MotionModel:
    torch.manual_seed(5)
    return MotionModel(SMALL).eval()


def _losses(
    model: MotionModel, weights: Mapping[str, float], draws: tuple[int, ...] = (0, 1)
) -> dict[str, torch.Tensor]:
    random = torch.Generator().manual_seed(2)
    motion = torch.randn(2, 12, 333, generator=random)
    latents = [torch.randn(2, 1, 8, generator=random) for _ in range(3)]
    noise = torch.randn(4, 2, 1, MOTION.width, generator=random)[[0, 1, *(2 + n for n in draws)]]
    steps = torch.tensor([[3, 700], [0, 500]])[list(draws)]
    return motion_losses(model, motion, latents, noise, steps, weights)


def _taught(model: MotionModel, weights: Mapping[str, float]) -> set[str]:
    """Return the networks that get a gradient of the loss."""
    model.zero_grad()
    torch.autograd.backward(_losses(model, weights)["loss"])
    return {
        name.rpartition(".")[2]
        for name in ("prior.encoder", "prior.decoder", "denoiser")
        if any(
            weight.grad is not None and weight.grad.any()
            for weight in model.get_submodule(name).parameters()
        )
    }


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
    assert _taught(model, {name: 1.0}) == taught


def test_the_latents_distance_is_that_of_two_normal_laws(model: MotionModel) -> None:
    motion = torch.randn(2, 12, 333, generator=torch.Generator().manual_seed(2))
    mu, std = model.prior.encode(motion)
    result = torch.distributions.kl_divergence(
        torch.distributions.Normal(mu, std), torch.distributions.Normal(0.0, 1.0)
    )
    assert float(_losses(model, MOTION_LOSSES)["kl"].detach()) == pytest.approx(
        float(result.mean().detach()), rel=1e-5
    )


@pytest.mark.parametrize("predicts", ["eps", "v"])
@torch.inference_mode()
def test_each_draw_of_noise_has_the_same_weight(predicts: Literal["eps", "v"]) -> None:
    torch.manual_seed(5)
    model = MotionModel(replace(SMALL, predicts=predicts)).eval()
    alone = [_losses(model, DENOISER_ALONE, draws=(draw,))["ld"] for draw in range(2)]
    together = _losses(model, DENOISER_ALONE)["ld"]
    assert float(together) == pytest.approx(float(sum(alone)) / 2)


def _speech_losses(weights: Mapping[str, float], heard: torch.Tensor) -> dict[str, float]:
    torch.manual_seed(1)
    model = SpeechModel(SPEECH).eval()
    losses = speech_losses(model, heard, heard, CLASSES, weights)
    return {name: float(value.detach()) for name, value in losses.items()}


def _four() -> torch.Tensor:
    return torch.randn(4, 64, 32, generator=torch.Generator().manual_seed(3))


def test_the_index_maps_are_those_printed_in_the_paper() -> None:
    assert tuple((6 - k) % 4 for k in range(1, 5)) == OTHER_CONTENT
    assert tuple((1 + k) % 4 for k in range(1, 5)) == OTHER_STYLE


def test_swapping_parts_of_equal_speech_costs_nothing() -> None:
    losses = _speech_losses(SPEECH_LOSSES, _four()[:1].expand(4, -1, -1))
    assert losses["con"] == pytest.approx(0, abs=1e-6)
    for name in ("xcon", "xemo", "xsty"):
        assert losses[name] == pytest.approx(losses["self"], rel=1e-5)


def test_contents_gain_nothing_by_all_coming_nearer() -> None:
    torch.manual_seed(1)
    model = SpeechModel(SPEECH).eval()
    result = []
    for _ in range(2):
        losses = speech_losses(model, _four(), _four(), CLASSES, SPEECH_LOSSES)
        result.append(float(losses["con"].detach()))
        weight = model.content.get_parameter("feature_head.1.weight")
        with torch.no_grad():
            weight.mul_(10)
    assert result[0] == pytest.approx(result[1], rel=0.1)
