from __future__ import annotations

import numpy as np
import pytest
import torch

from training.hearing.hubert import HOP, WINDOW, Heard, SoundContext

RATE = 16_000
CHANNELS = 249
BANDS = slice(64)
STRESS = slice(64, None)


@pytest.fixture(scope="module")
def network() -> SoundContext:
    return SoundContext(CHANNELS, seed=3)


def heard(network: SoundContext, samples: np.ndarray) -> torch.Tensor:
    found: Heard = network(torch.from_numpy(samples.astype(np.float32))[None])
    return found.last_hidden_state[0]


def noise(seconds: float) -> np.ndarray:
    return np.random.default_rng(1).standard_normal(round(seconds * RATE))


@pytest.mark.parametrize(("told", "nearest", "furthest"), [(BANDS, 22, 26), (STRESS, 34, 37)])
def test_a_sound_is_told_before_and_after_it_and_no_further(
    network: SoundContext, told: slice, nearest: int, furthest: int
) -> None:
    silent = np.zeros(4 * RATE)
    struck = silent.copy()
    struck[2 * RATE : 2 * RATE + 40] = 5.0
    differs = heard(network, struck)[:, told] != heard(network, silent)[:, told]
    changed = differs.any(dim=1).nonzero()[:, 0]
    first, last = (2 * RATE - WINDOW) // HOP, (2 * RATE + 40) // HOP
    assert first - furthest <= int(changed[0]) <= first - nearest
    assert last + nearest <= int(changed[-1]) <= last + furthest


def test_the_loudest_moment_around_is_told_as_a_syllable(network: SoundContext) -> None:
    loudness = np.full(2 * RATE, 0.2)
    for moment, height in ((0.5, 1.0), (0.75, 0.5), (1.4, 0.8)):
        loudness += height * np.exp(-(((np.arange(2 * RATE) / RATE - moment) / 0.04) ** 2))
    stress = heard(network, loudness * noise(2))[:, STRESS].reshape(-1, 37, 5)
    widest = stress[:, 18, 4]
    for moment in (0.5, 1.4):
        place = round((moment * RATE - WINDOW / 2) / HOP)
        assert widest[place - 2 : place + 3].max() > 0.5
    assert widest[round((0.75 * RATE - WINDOW / 2) / HOP)] == 0
