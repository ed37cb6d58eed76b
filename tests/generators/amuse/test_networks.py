"""AMUSE's networks and their losses."""

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
)
from generators.amuse.model import Denoiser, MotionModel, MotionPrior
from generators.amuse.speech import SpeechEncoder, SpeechModel
from generators.amuse.train import initialise_prior
from tests.generators.amuse.small_networks import MOTION, SMALL_SPEECH
from training.diffusion import SCALED_LINEAR

SMALL = replace(MOTION, motion_width=12, frames=20, longest=40)


@pytest.fixture(autouse=True)
def _seeded() -> None:
    torch.manual_seed(7)


@torch.inference_mode()
def test_motion_and_latents_do_not_depend_on_the_rest_of_the_batch() -> None:
    model, speech_model = MotionModel(SMALL).eval(), SpeechModel(SMALL_SPEECH).eval()
    filterbanks = torch.randn(3, 64, 32)
    motion, noise, *speech = torch.randn(3, 20, 12), *torch.randn(4, 3, 1, 16)
    speech = [condition[..., :8] for condition in speech]
    steps = torch.tensor([5, 500, 900])
    alone = slice(1, 2)
    few = [condition[alone] for condition in speech]
    for together, expected in (
        (model.prior.encode(motion)[0], model.prior.encode(motion[alone])[0]),
        (model.prior.decode(noise), model.prior.decode(noise[alone])),
        (model.denoiser(noise, steps, *speech), model.denoiser(noise[alone], steps[alone], *few)),
        (model.sample(noise, speech, steps=5), model.sample(noise[alone], few, steps=5)),
        *zip(speech_model(filterbanks), speech_model(filterbanks[alone]), strict=True),
    ):
        torch.testing.assert_close(together[alone], expected)


def test_the_noise_follows_from_a_predicted_velocity(monkeypatch: pytest.MonkeyPatch) -> None:
    denoiser = Denoiser(replace(SMALL, predicts="v")).eval()
    z0, eps = torch.randn(2, 3, 1, SMALL.width)
    t = torch.tensor([10, 500, 990])
    monkeypatch.setattr(denoiser, "predict", lambda *_: SCALED_LINEAR.v(z0, eps, t))
    result = denoiser(SCALED_LINEAR.x_t(z0, eps, t), t)
    assert torch.allclose(result, eps, atol=1e-5)


def test_the_linear_layers_of_a_fresh_prior_keep_the_motions_principal_components() -> None:
    components = torch.randn(20, SMALL.frames, 5) @ torch.randn(5, SMALL.motion_width)
    motion = 1 + 0.05 * components
    prior = MotionPrior(replace(SMALL, tokens=2))
    initialise_prior(prior, motion)
    embedded = prior.skel_embedding(motion)
    assert (prior.final_layer(embedded) - motion).abs().max() < 1e-3
    assert (embedded.std(dim=(0, 1))[:5] - 1).abs().max() < 0.05


@pytest.mark.parametrize("classified", ["tokens", "latent"])
def test_the_emotions_classifier_may_be_the_latent_itself(
    classified: Literal["tokens", "latent"],
) -> None:
    encoder = SpeechEncoder(replace(SMALL_SPEECH, classified=classified), classes=3).eval()
    _, logits = encoder(torch.randn(2, 64, 32))
    assert logits is not None
    logits.sum().backward()
    weight = encoder.feature_head[1].weight
    assert (weight.grad is not None) == (classified == "latent")


SMALL_MOTION = replace(MOTION, frames=12)
CLASSES = torch.tensor([[0, 0, 0, 0], [0, 0, 1, 1]])
"""Emotions and speakers of a quadruple."""


@pytest.fixture(name="model")
def _small_model() -> MotionModel:
    torch.manual_seed(5)
    return MotionModel(SMALL_MOTION).eval()


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
def test_each_loss_trains_the_networks_named_in_the_paper(
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


def test_the_latent_distance_is_that_of_two_normal_distributions(model: MotionModel) -> None:
    motion = torch.randn(2, 12, 333, generator=torch.Generator().manual_seed(2))
    mu, std = model.prior.encode(motion)
    result = torch.distributions.kl_divergence(
        torch.distributions.Normal(mu, std), torch.distributions.Normal(0.0, 1.0)
    )
    assert float(_losses(model, MOTION_LOSSES)["kl"].detach()) == pytest.approx(
        float(result.mean().detach()), rel=1e-5
    )


def _four() -> torch.Tensor:
    return torch.randn(4, 64, 32, generator=torch.Generator().manual_seed(3))


def test_the_index_maps_are_those_printed_in_the_paper() -> None:
    assert tuple((6 - k) % 4 for k in range(1, 5)) == OTHER_CONTENT
    assert tuple((1 + k) % 4 for k in range(1, 5)) == OTHER_STYLE


@torch.no_grad()
def test_swapping_parts_of_equal_speech_costs_nothing() -> None:
    equal = _four()[:1].expand(4, -1, -1)
    losses = speech_losses(SpeechModel(SMALL_SPEECH).eval(), equal, equal, CLASSES, SPEECH_LOSSES)
    assert float(losses["con"]) == pytest.approx(0, abs=1e-6)
    for name in ("xcon", "xemo", "xsty"):
        assert float(losses[name]) == pytest.approx(float(losses["self"]), rel=1e-5)


@torch.no_grad()
def test_content_loss_does_not_depend_on_the_scale_of_features() -> None:
    model = SpeechModel(SMALL_SPEECH).eval()
    result = []
    for _ in range(2):
        losses = speech_losses(model, _four(), _four(), CLASSES, SPEECH_LOSSES)
        result.append(float(losses["con"]))
        model.content.get_parameter("feature_head.1.weight").mul_(10)
    assert result[0] == pytest.approx(result[1], rel=0.1)
