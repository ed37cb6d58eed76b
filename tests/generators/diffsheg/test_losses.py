"""What DiffSHEG learns by, beside sums written out from the paper's equations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from generators.diffsheg.losses import LOSSES, LossWeights, motion_losses
from training.diffusion import LINEAR

STEPS = torch.tensor([0, 250, 500])


@pytest.fixture
def windows() -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Return clean motion, noise and what a network might say, three windows of two values."""
    random = torch.Generator().manual_seed(4)
    clean, noise, mistaken = (torch.randn(3, 5, 2, generator=random) for _ in range(3))
    return clean, noise, noise + 0.1 * mistaken


def told(noise: torch.Tensor, found: torch.Tensor, name: str = "paper") -> dict[str, float]:
    losses = motion_losses(noise, found, STEPS, LOSSES[name])
    return {name: float(value) for name, value in losses.items()}


def test_velocity_and_reconstruction_are_those_of_the_motion_that_follows_from_the_noise(
    windows: tuple[torch.Tensor, torch.Tensor, torch.Tensor],
) -> None:
    clean, noise, found = windows
    noisy = LINEAR.x_t(clean, noise, STEPS)
    estimate = LINEAR.x0_hat(noisy, found, STEPS).double().numpy()
    true = clean.double().numpy()
    velocity = np.mean((np.diff(true, axis=1) - np.diff(estimate, axis=1)) ** 2)
    missed = np.abs(true - estimate)
    huber = np.mean(np.where(missed < 0.1, missed**2 / 2, 0.1 * (missed - 0.05)))
    losses = told(noise, found)
    assert losses["noise"] == pytest.approx(float((noise - found).square().mean()))
    assert losses["velocity"] == pytest.approx(velocity, rel=1e-4)
    assert losses["reconstruction"] == pytest.approx(huber, rel=1e-4)


def test_the_paper_weighs_ten_to_one_to_one(
    windows: tuple[torch.Tensor, torch.Tensor, torch.Tensor],
) -> None:
    _, noise, found = windows
    losses = told(noise, found)
    expected = 10 * losses["noise"] + losses["velocity"] + losses["reconstruction"]
    assert losses["loss"] == pytest.approx(expected)


def test_the_release_weighs_a_thousand_to_one_to_a_hundred_of_a_steeper_huber(
    windows: tuple[torch.Tensor, torch.Tensor, torch.Tensor],
) -> None:
    _, noise, found = windows
    papers, losses = told(noise, found), told(noise, found, "release")
    assert losses["reconstruction"] == pytest.approx(10 * papers["reconstruction"])
    expected = 1000 * losses["noise"] + losses["velocity"] + 100 * losses["reconstruction"]
    assert losses["loss"] == pytest.approx(expected)


def test_errors_in_meaningful_frames_count_more_where_the_weights_say_so() -> None:
    noise, semantic = torch.zeros(1, 4, 2), torch.zeros(1, 4, 1)
    semantic[0, 1] = 1.0
    steps = torch.tensor([300])

    def reconstruction(frame: int, weights: LossWeights) -> float:
        found = noise.clone()
        found[0, frame] = 10.0
        return float(motion_losses(noise, found, steps, weights, semantic)["reconstruction"])

    plain, counted = LOSSES["paper"], replace(LOSSES["paper"], semantic=True)
    assert reconstruction(1, plain) == reconstruction(2, plain)
    assert reconstruction(1, counted) == pytest.approx(2 * reconstruction(2, counted), rel=0.01)
