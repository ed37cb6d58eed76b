"""The motion prior and the latent denoiser."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch

from generators.amuse.model import Denoiser, MotionModel, MotionPrior
from tests.generators.amuse.small_networks import MOTION
from training.diffusion import SCALED_LINEAR

SMALL = replace(MOTION, motion_width=12, frames=20, longest=40)


@pytest.fixture(autouse=True)
def _seeded() -> None:
    torch.manual_seed(7)


def test_the_prior_codes_each_motion_by_itself() -> None:
    prior = MotionPrior(SMALL).eval()
    motion = torch.randn(3, 20, 12)
    with torch.inference_mode():
        together, alone = prior.encode(motion), prior.encode(motion[2:])
        decoded = prior.decode(together.mu)
        torch.testing.assert_close(together.mu[2:], alone.mu)
        torch.testing.assert_close(decoded[2:], prior.decode(alone.mu))
    assert decoded.shape == motion.shape
    assert (together.std > 0).all()


def test_the_noise_found_hangs_on_every_condition_and_on_the_step() -> None:
    denoiser = Denoiser(SMALL).eval()
    z, content, emotion, style = torch.randn(1, 1, 16), *torch.randn(3, 1, 1, 8).abs()
    timestep = torch.tensor(3)
    with torch.inference_mode():
        eps = denoiser(z, timestep, content, emotion, style)
        for changed in (
            (timestep + 500, content, emotion, style),
            (timestep, content + 1, emotion, style),
            (timestep, content, emotion + 1, style),
            (timestep, content, emotion, style + 1),
            (timestep, emotion, content, style),
        ):
            assert not torch.allclose(denoiser(z, *changed), eps, atol=1e-4)
    assert eps.shape == z.shape


def test_each_latent_of_a_batch_has_its_own_step() -> None:
    denoiser = Denoiser(SMALL).eval()
    z, conditions = torch.randn(2, 1, 16), [torch.randn(2, 1, 8) for _ in range(3)]
    with torch.inference_mode():
        together = denoiser(z, torch.tensor([5, 900]), *conditions)
        alone = denoiser(z[1:], torch.tensor(900), *(one[1:] for one in conditions))
    torch.testing.assert_close(together[1:], alone)


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


def test_equal_noise_gives_equal_latents_in_any_batch() -> None:
    model = MotionModel(SMALL).eval()
    noise, *speech = torch.randn(9, 1, SMALL.width), *torch.randn(3, 9, 1, SMALL.condition_width)
    with torch.inference_mode():
        many = model.sample(noise, speech, steps=5)
        few = model.sample(noise[:2], [one[:2] for one in speech], steps=5)
    assert many.shape == noise.shape
    torch.testing.assert_close(many[:2], few)
