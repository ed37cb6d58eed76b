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


@pytest.mark.parametrize(("samples", "features"), [(400, 1), (719, 1), (720, 2), (16_000, 49)])
def test_there_is_a_feature_for_every_place_of_its_window(
    network: SoundContext, samples: int, features: int
) -> None:
    assert heard(network, noise(1)[:samples]).shape == (features, CHANNELS)


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


def test_pitch_and_loudness_are_told_apart(network: SoundContext) -> None:
    time = np.arange(RATE) / RATE
    low, high = (np.sin(2 * np.pi * pitch * time) for pitch in (200, 800))
    middle = [heard(network, one)[24, BANDS] for one in (low, high, 0.2 * low)]
    assert float((middle[0] - middle[1]).abs().mean()) > 0.05
    assert float((middle[0] - middle[2]).abs().mean()) > 0.05


def test_seeds_mix_otherwise_and_one_seed_always_alike() -> None:
    samples = noise(0.5)
    one, same, other = (heard(SoundContext(193, seed), samples) for seed in (1, 1, 2))
    assert torch.equal(one, same)
    assert not torch.allclose(one, other)
