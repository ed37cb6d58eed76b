"""The motion prior and the latent denoiser."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch

from generators.amuse.model import Denoiser, MotionModel, MotionPrior
from generators.amuse.train import initialise_prior
from tests.generators.amuse.small_networks import MOTION
from training.diffusion import SCALED_LINEAR

SMALL = replace(MOTION, motion_width=12, frames=20, longest=40)


@pytest.fixture(autouse=True)
def _seeded() -> None:
    torch.manual_seed(7)


@torch.inference_mode()
def test_motion_and_latents_do_not_depend_on_the_others_of_a_batch() -> None:
    model = MotionModel(SMALL).eval()
    motion, noise, *speech = torch.randn(3, 20, 12), *torch.randn(4, 3, 1, 16)
    speech = [condition[..., :8] for condition in speech]
    steps = torch.tensor([5, 500, 900])
    alone = slice(1, 2)
    few = [condition[alone] for condition in speech]
    for together, expected in (
        (model.prior.encode(motion).mu, model.prior.encode(motion[alone]).mu),
        (model.prior.decode(noise), model.prior.decode(noise[alone])),
        (model.denoiser(noise, steps, *speech), model.denoiser(noise[alone], steps[alone], *few)),
        (model.sample(noise, speech, steps=5), model.sample(noise[alone], few, steps=5)),
    ):
        torch.testing.assert_close(together[alone], expected)


def test_the_noise_follows_from_a_predicted_velocity(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    torch.manual_seed(4)
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
