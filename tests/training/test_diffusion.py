"""The diffusion schedule against its definition."""

import math

import pytest
import torch

from training.diffusion import LINEAR, SCALED_LINEAR


def test_the_first_and_last_alpha_bar_match_the_paper() -> None:
    assert LINEAR.alpha_bar[0] == pytest.approx(1 - 1e-4)
    logarithm = sum(math.log1p(-(1e-4 + (0.02 - 1e-4) * step / 999)) for step in range(1000))
    assert LINEAR.alpha_bar[-1] == pytest.approx(math.exp(logarithm))


def test_the_standard_deviation_of_scaled_noise_grows_linearly() -> None:
    alpha_bar = 1.0
    for step in range(1000):
        deviation = math.sqrt(0.00085) + (math.sqrt(0.012) - math.sqrt(0.00085)) * step / 999
        alpha_bar *= 1 - deviation**2
    assert SCALED_LINEAR.alpha_bar[-1] == pytest.approx(alpha_bar)


def test_noise_of_a_known_motion_is_removed_in_evenly_spaced_steps() -> None:
    clean = torch.full((1, 1, 3), 2.0)
    steps_asked = []

    def eps_of(x_t: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
        steps_asked.append(int(t))
        alpha_bar = SCALED_LINEAR.alpha_bar[int(t)]
        return (x_t - math.sqrt(alpha_bar) * clean) / math.sqrt(1 - alpha_bar)

    noise = torch.randn(1, 1, 3, generator=torch.Generator().manual_seed(2))
    result = SCALED_LINEAR.ddim(noise, eps_of, steps=50)
    assert steps_asked == list(range(981, 0, -20))
    left = 1 - SCALED_LINEAR.alpha_bar[0]
    assert torch.allclose(result, clean, atol=3 * math.sqrt(left))
    limited = SCALED_LINEAR.ddim(noise, eps_of, steps=50, clip=1.0)
    # Each step keeps its noise, and replaces the clean values of 2 by their limit of 1.
    expected = noise
    for step in range(981, 0, -20):
        alpha_bar = SCALED_LINEAR.alpha_bar[[step, max(step - 20, 0)]]
        eps = (expected - math.sqrt(alpha_bar[0]) * clean) / math.sqrt(1 - alpha_bar[0])
        expected = math.sqrt(alpha_bar[1]) * torch.ones(3) + math.sqrt(1 - alpha_bar[1]) * eps
    assert torch.allclose(limited, expected, atol=1e-4)
