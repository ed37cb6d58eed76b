"""The linear estimate of the noise, beside the law it is derived from."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from training.diffusion import LINEAR
from training.layers.linear_skip import LinearSkip

FRAMES, PART = 12, 3
STEPS = (0, 300, 700)


def smooth_windows(count: int = 4000) -> np.ndarray:
    """Return windows of one slow curve, which moves the first two of three values together."""
    chance = np.random.default_rng(5)
    times = (np.arange(FRAMES) + 0.5) / FRAMES
    amounts = chance.standard_normal((count, 2))
    curves = amounts[:, :1] + amounts[:, 1:] * np.cos(np.pi * times)
    windows = np.stack([curves, 0.5 * curves, np.zeros_like(curves)], axis=-1)
    return windows.astype(np.float32)


def told() -> LinearSkip:
    skip = LinearSkip(FRAMES, PART)
    skip.tell(smooth_windows())
    return skip


@pytest.mark.parametrize("step", STEPS)
def test_no_other_linear_estimate_of_gaussian_motion_is_better(step: int) -> None:
    windows = smooth_windows().astype(np.float64)
    flat = windows.reshape(len(windows), -1)
    kept = LINEAR.alpha_bar[step]
    covariance = kept * flat.T @ flat / len(flat) + (1 - kept) * np.eye(flat.shape[1])
    noisy = np.random.default_rng(1).standard_normal((4, FRAMES, PART))
    # The expectation of the noise, given the sum: its covariance with it over the sum's own.
    expected = np.sqrt(1 - kept) * np.linalg.solve(covariance, noisy.reshape(4, -1).T).T
    found = told()(torch.zeros(4, FRAMES, PART), torch.from_numpy(noisy), torch.tensor([step]))
    np.testing.assert_allclose(found.reshape(4, -1), expected, rtol=0.02, atol=0.02)


@pytest.mark.parametrize("frames", [1, 5, 11])
def test_shorter_windows_keep_slow_motion_too(frames: int) -> None:
    clean = torch.from_numpy(smooth_windows(1)[:, :frames])
    noise = torch.randn(clean.shape, generator=torch.Generator().manual_seed(4))
    steps = torch.tensor([200])
    noisy = LINEAR.x_t(clean, noise, steps)
    found = told()(torch.zeros_like(noisy), noisy, steps)
    missed = LINEAR.x0_hat(noisy, found, steps) - clean
    assert missed.square().mean() < 0.5 * (noisy - clean).square().mean()
