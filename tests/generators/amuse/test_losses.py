"""AMUSE's losses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest
import torch

from generators.amuse.losses import (
    MOTION_LOSSES,
    OTHER_CONTENT,
    OTHER_STYLE,
    SPEECH_LOSSES,
    motion_losses,
    speech_losses,
)
from generators.amuse.model import MotionModel
from generators.amuse.speech import SpeechModel
from tests.generators.amuse.small_networks import MOTION
from tests.generators.amuse.test_speech import SMALL as SPEECH

SMALL = replace(MOTION, frames=12)
CLASSES = torch.tensor([[0, 0, 0, 0], [0, 0, 1, 1]])
"""Emotions and speakers of a quadruple."""


@pytest.fixture(name="model")
def _model() -> MotionModel:
    torch.manual_seed(5)
    return MotionModel(SMALL).eval()


def _losses(model: MotionModel, weights: Mapping[str, float]) -> dict[str, torch.Tensor]:
    random = torch.Generator().manual_seed(2)
    motion = torch.randn(2, 12, 333, generator=random)
    latents = [torch.randn(2, 1, 8, generator=random) for _ in range(3)]
    noise = torch.randn(4, 2, 1, MOTION.width, generator=random)
    steps = torch.tensor([[3, 700], [0, 500]])
    return motion_losses(model, motion, latents, noise, steps, weights)


@pytest.mark.parametrize(
    ("name", "taught"),
    [
        ("rec", {"prior.encoder", "prior.decoder"}),
        ("vrec", {"prior.encoder", "prior.decoder"}),
        ("velocity", {"prior.encoder", "prior.decoder"}),
        ("kl", {"prior.encoder"}),
        ("ld", {"denoiser"}),
        ("align", {"prior.decoder"}),
        ("valign", {"prior.decoder"}),
    ],
)
def test_each_loss_teaches_the_networks_that_the_paper_says(
    model: MotionModel, name: str, taught: set[str]
) -> None:
    torch.autograd.backward(_losses(model, {name: 1.0})["loss"])
    learning = {
        part
        for part in ("prior.encoder", "prior.decoder", "denoiser")
        if any(
            weight.grad is not None and weight.grad.any()
            for weight in model.get_submodule(part).parameters()
        )
    }
    assert learning == taught


def test_the_latents_distance_is_that_of_two_normal_laws(model: MotionModel) -> None:
    motion = torch.randn(2, 12, 333, generator=torch.Generator().manual_seed(2))
    mu, std = model.prior.encode(motion)
    result = torch.distributions.kl_divergence(
        torch.distributions.Normal(mu, std), torch.distributions.Normal(0.0, 1.0)
    )
    assert float(_losses(model, MOTION_LOSSES)["kl"].detach()) == pytest.approx(
        float(result.mean().detach()), rel=1e-5
    )


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
