"""Convolutions on graphs gather from neighbours alone, and components from their own nodes."""

from typing import Final

import numpy as np
import pytest
import torch

from generators.diffsheg.layers import LinearSkip
from tests.generators.s2ue.small_network import FACE
from training.diffusion import LINEAR
from training.layers.convolutions import (
    bone_graph,
    component_graph,
    components_of,
    face_graph,
    lips_of,
)

COMPONENTS: Final = components_of(FACE.actions)


def test_landmarks_form_four_components_with_the_lips_for_phonemes() -> None:
    eyes, nose, lips, jaw = COMPONENTS
    assert sorted((*eyes, *nose, *lips, *jaw)) == list(range(FACE.count))
    assert all(FACE.actions[one].startswith(("brow", "eye")) for one in eyes)
    corners = set(lips) - set(lips_of(FACE.actions))
    assert {FACE.actions[one][:9] for one in corners} >= {"mouthSmil", "mouthFrow"}


def test_graphs_have_the_edges_of_the_paper() -> None:
    bones = bone_graph(2)
    assert bones[4, 5] == bones[3, 5] == 1  # upper arm and forearm; through a third bone
    assert bones[5, 8] == 0  # the two forearms
    components = component_graph(3, pose=True)
    assert components[0, 1] == components[0, 2] == 1
    assert components[1, 2] == 0
    assert component_graph(4, pose=False).sum() == 12
    face = face_graph(COMPONENTS, FACE.neutral)
    np.testing.assert_array_equal(face, face.T)
    eyes, _, lips, _ = COMPONENTS
    assert face[eyes[0], eyes[1]] == 1
    assert face[np.ix_(eyes, lips)].sum() == 1


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
    skip.fit(smooth_windows())
    return skip


@pytest.mark.parametrize("step", STEPS)
def test_the_linear_estimate_of_gaussian_motion_is_optimal(step: int) -> None:
    windows = smooth_windows().astype(np.float64)
    flat = windows.reshape(len(windows), -1)
    alpha_bar = LINEAR.alpha_bar[step]
    covariance = alpha_bar * flat.T @ flat / len(flat) + (1 - alpha_bar) * np.eye(flat.shape[1])
    noisy = np.random.default_rng(1).standard_normal((4, FRAMES, PART))
    # The expectation of the noise, given the sum: its covariance with it over the sum's own.
    expected = np.sqrt(1 - alpha_bar) * np.linalg.solve(covariance, noisy.reshape(4, -1).T).T
    result = told()(torch.zeros(4, FRAMES, PART), torch.from_numpy(noisy), torch.tensor([step]))
    np.testing.assert_allclose(result.reshape(4, -1), expected, rtol=0.02, atol=0.02)


@pytest.mark.parametrize("frames", [1, 5, 11])
def test_shorter_windows_keep_slow_motion(frames: int) -> None:
    clean = torch.from_numpy(smooth_windows(1)[:, :frames])
    noise = torch.randn(clean.shape, generator=torch.Generator().manual_seed(4))
    steps = torch.tensor([200])
    noisy = LINEAR.x_t(clean, noise, steps)
    result = told()(torch.zeros_like(noisy), noisy, steps)
    missed = LINEAR.x0_hat(noisy, result, steps) - clean
    assert missed.square().mean() < 0.5 * (noisy - clean).square().mean()
