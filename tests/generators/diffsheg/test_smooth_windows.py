"""A perfect network's motion goes on over the borders of windows as it does within them.

The network is perfect for motion of a known normal law, whose values are related over time and
not among each other; so whatever shows at the borders is the sampling's own doing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Literal

import numpy as np
import pytest
import torch
from torch import Tensor

from benchmarks.seams import Windows, seam_acceleration
from generators.diffsheg.config import SAMPLINGS, Sampling
from generators.diffsheg.sampling import Estimate, Sampler, Window, sample_windows, stream
from training.diffusion import LINEAR
from training.speech_features.speech_frames import SpeechFrames

FRAMES, OVERLAP, VALUES, LENGTH = 34, 4, 32, 900
RELATED_OVER = 0.2
"""Seconds over which quick parts of the motion are related; slow ones, over six times as many."""


def covariance() -> np.ndarray:
    seconds = np.subtract.outer(np.arange(FRAMES), np.arange(FRAMES)) / 15
    quick, slow = (np.exp(-0.5 * (seconds / (n * RELATED_OVER)) ** 2) for n in (1, 6))
    return 0.5 * quick + 0.5 * slow + 1e-4 * np.eye(FRAMES)


def perfect_network(sampling: Sampling) -> Sampler:
    law = torch.from_numpy(covariance())

    @cache
    def answers(place: int, frames: int) -> Tensor:
        alpha_bar = float(LINEAR.alpha_bar[sampling.timesteps[place]])
        noisy = alpha_bar * law[:frames, :frames] + (1 - alpha_bar) * torch.eye(frames)
        deviation: float = (1 - alpha_bar) ** 0.5
        answer: Tensor = deviation * torch.linalg.inv(noisy)
        return answer.float()

    def told(speech: SpeechFrames) -> Estimate:
        def estimate(noisy: Tensor, place: int) -> Tensor:
            return answers(place, len(speech)) @ noisy

        return estimate

    def moved(windows: Sequence[Window], known: Tensor | None) -> list[Tensor]:
        asked = ((told(window.speech), window.noise) for window in windows)
        return sample_windows(asked, sampling, known)

    return moved


def moved(preset: Literal["smooth", "fast"]) -> np.ndarray:
    sampling = replace(SAMPLINGS[preset], overlap=OVERLAP)
    nothing = torch.zeros(LENGTH, 1)
    parts = stream(
        [SpeechFrames(nothing, nothing)],
        perfect_network(sampling),
        frames=FRAMES,
        width=VALUES,
        sampling=sampling,
        seed=1,
    )
    return torch.cat(list(parts)).numpy().astype(float)


@pytest.fixture(scope="module")
def smooth() -> np.ndarray:
    return moved("smooth")


@pytest.fixture(scope="module")
def fast() -> np.ndarray:
    return moved("fast")


def at_seams(motion: np.ndarray) -> float:
    windows = Windows(frames=FRAMES, overlap=OVERLAP, frame_rate=15)
    return seam_acceleration(motion[:, :, None], windows, of="values").value


def test_accelerations_at_the_borders_are_those_elsewhere(
    smooth: np.ndarray, fast: np.ndarray
) -> None:
    assert at_seams(smooth) < 1.15
    assert at_seams(smooth) < at_seams(fast) - 0.05


def test_poses_vary_as_the_law_has_it_and_do_not_fade_to_the_mean(
    smooth: np.ndarray, fast: np.ndarray
) -> None:
    assert smooth.std() == pytest.approx(1, abs=0.08)
    assert fast.std() < 0.92
