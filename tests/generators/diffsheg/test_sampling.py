"""Motion of any length, of whole or live speech, equals that of running the whole network."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache, partial
from itertools import pairwise
from typing import Literal, get_args

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from benchmarks.seams import Windows, seam_acceleration
from generators.diffsheg.config import SAMPLINGS, Flow, Sampling
from generators.diffsheg.model import Denoiser
from generators.diffsheg.sampling import (
    Sampler,
    Window,
    WindowSampler,
    draw_noise,
    sample_window,
    sample_windows,
    stream,
)
from motion.errors import InputError
from tests.generators.diffsheg.small_network import TINY, shaken
from training.device import torch_threads
from training.diffusion import LINEAR
from training.speech_features.speech_frames import SpeechFrames

SMALL = replace(TINY, speech_features=8, audio_width=8, frames=8)
SAMPLING = Sampling(steps=8, overlap=3)
WIDTH, FRAMES = SMALL.motion_width, SMALL.frames
GUIDED_OR_NOT = ((None, False), (1.3, True))
PERSON = torch.tensor([0.0, 1.0, 0.0])


def asked_in_full(denoiser: Denoiser) -> Sampler:
    """Return a sampler that runs the whole network at each evaluation."""

    def eps(x_t: Tensor, place: int, speech: SpeechFrames) -> Tensor:
        t = torch.tensor([SAMPLING.timesteps[place]])
        result: Tensor = denoiser(x_t, t, speech.mel[None], speech.hubert[None], PERSON[None])
        return result

    def sample(windows: Sequence[Window], known: Tensor | None) -> list[Tensor]:
        asked = ((partial(eps, speech=window.speech), window.noise) for window in windows)
        return sample_windows(asked, SAMPLING, known)

    return sample


NETWORK = shaken(SMALL, 0.2).requires_grad_(False)


def spoken(frames: int) -> SpeechFrames:
    random = torch.Generator().manual_seed(3)
    return SpeechFrames(
        5 * torch.rand(frames, SMALL.audio_width, generator=random),
        torch.randn(frames, SMALL.speech_features, generator=random),
    )


def moved(
    sampler: Sampler, pieces: Sequence[SpeechFrames] = (spoken(24),), sampling: Sampling = SAMPLING
) -> Tensor:
    return torch.cat(
        list(stream(pieces, sampler, frames=FRAMES, width=WIDTH, sampling=sampling, seed=1))
    )


@settings(max_examples=8, deadline=None)
@given(st.lists(st.integers(1, 9), min_size=1, max_size=8), st.sampled_from([0, 3]))
def test_chunking_of_speech_does_not_change_the_motion(lengths: list[int], overlap: int) -> None:
    sampling = replace(SAMPLING, overlap=overlap)
    sampler = WindowSampler(NETWORK, PERSON, sampling)
    whole = spoken(sum(lengths))
    ends = np.cumsum(lengths)
    pieces = [
        whole.slice(end - length, end) for length, end in zip(lengths, map(int, ends), strict=True)
    ]
    motion = moved(sampler, [whole], sampling)
    assert len(motion) == len(whole)
    assert torch.equal(moved(sampler, pieces, sampling), motion)


def test_motion_is_available_before_the_speech_ends() -> None:
    asked: list[int] = []

    def pieces() -> Iterator[SpeechFrames]:
        for number in range(4):
            asked.append(number)
            yield spoken(FRAMES)

    sampler = WindowSampler(NETWORK, PERSON, SAMPLING)
    settled = stream(pieces(), sampler, frames=FRAMES, width=WIDTH, sampling=SAMPLING, seed=1)
    assert len(next(settled)) == FRAMES - SAMPLING.overlap
    assert asked == [0]
    with pytest.raises(InputError, match="cannot share 8"):
        moved(sampler, sampling=replace(SAMPLING, overlap=FRAMES))


@pytest.mark.parametrize("name", ["fast", "smooth"])
def test_shared_frames_connect_one_window_to_the_next(name: str) -> None:
    sampling = replace(SAMPLINGS[name], overlap=4)

    def always_two(noisy: Tensor, place: int) -> Tensor:
        alpha_bar = float(LINEAR.alpha_bar[sampling.timesteps[place]])
        noise: Tensor = (noisy - 2 * alpha_bar**0.5) / (1 - alpha_bar) ** 0.5
        return noise

    noise = draw_noise((6, 1), sampling, torch.Generator().manual_seed(2), continues=True)
    motion = sample_window(always_two, sampling, noise, torch.full((4, 1), -1.0))
    expected = [-1.0, -0.25, 0.5, 1.25, 2.0, 2.0]
    np.testing.assert_allclose(motion[:, 0], expected, rtol=0, atol=1e-5)


@pytest.mark.parametrize(
    ("flow", "guidance", "skip", "number"),
    [
        *((flow, guidance, skip, 1) for flow in get_args(Flow) for guidance, skip in GUIDED_OR_NOT),
        *(("joint", guidance, skip, 2) for guidance, skip in GUIDED_OR_NOT),
    ],
)
def test_the_motion_equals_that_of_the_plain_network(
    flow: Flow, guidance: float | None, skip: bool, number: int
) -> None:
    config = replace(SMALL, flow=flow, guidance=guidance, skip=skip)
    denoiser = shaken(config, 0.2).requires_grad_(False)
    plain = moved(asked_in_full(denoiser))
    with torch_threads(number):
        result = moved(WindowSampler(denoiser, PERSON, SAMPLING))
    assert float((result - plain).abs().max()) < 1e-4 * float(plain.abs().max())


def test_everything_runs_on_the_networks_device() -> None:
    """Values on 'meta' are not computed, but may not be mixed with values on other devices."""
    denoiser = shaken(replace(SMALL, guidance=1.3, layers=1)).requires_grad_(False).to("meta")
    assert moved(WindowSampler(denoiser, PERSON, SAMPLING)).device.type == "meta"


@pytest.mark.parametrize(
    ("name", "asked"), [("smooth", 27), ("fast", 27), ("careful", 63), ("plain", 15)]
)
def test_a_named_sampling_evaluates_the_network_as_often_as_documented(
    name: str, asked: int
) -> None:
    walk = SAMPLINGS[name].later_walk
    assert sum(there < here for here, there in pairwise(walk)) == asked


WINDOW, OVERLAP, VALUES, LENGTH = 34, 4, 32, 900
RELATED_OVER = 0.2
"""Seconds over which quick parts of the motion are related; slow ones, over six times as many."""


def covariance() -> np.ndarray:
    seconds = np.subtract.outer(np.arange(WINDOW), np.arange(WINDOW)) / 15
    quick, slow = (np.exp(-0.5 * (seconds / (n * RELATED_OVER)) ** 2) for n in (1, 6))
    return 0.5 * quick + 0.5 * slow + 1e-4 * np.eye(WINDOW)


def perfect_network(sampling: Sampling) -> Sampler:
    """Return the perfect network for normally distributed motion that is correlated over time.

    Whatever shows at the borders of windows is then the sampling's own doing.
    """
    law = torch.from_numpy(covariance())

    @cache
    def answers(place: int, frames: int) -> Tensor:
        alpha_bar = float(LINEAR.alpha_bar[sampling.timesteps[place]])
        noisy = alpha_bar * law[:frames, :frames] + (1 - alpha_bar) * torch.eye(frames)
        deviation: float = (1 - alpha_bar) ** 0.5
        answer: Tensor = deviation * torch.linalg.inv(noisy)
        return answer.float()

    def sampled(windows: Sequence[Window], known: Tensor | None) -> list[Tensor]:
        def estimate(noisy: Tensor, place: int) -> Tensor:
            return answers(place, noisy.shape[1]) @ noisy

        return sample_windows(((estimate, window.noise) for window in windows), sampling, known)

    return sampled


@cache
def sampled(preset: Literal["smooth", "fast"]) -> np.ndarray:
    sampling = replace(SAMPLINGS[preset], overlap=OVERLAP)
    nothing = torch.zeros(LENGTH, 1)
    parts = stream(
        [SpeechFrames(nothing, nothing)],
        perfect_network(sampling),
        frames=WINDOW,
        width=VALUES,
        sampling=sampling,
        seed=1,
    )
    return torch.cat(list(parts)).numpy().astype(float)


def at_seams(preset: Literal["smooth", "fast"]) -> float:
    windows = Windows(frames=WINDOW, overlap=OVERLAP, frame_rate=15)
    return seam_acceleration(sampled(preset)[:, :, None], windows, of="values").value


def test_windows_join_smoothly_and_poses_do_not_fade_to_the_mean() -> None:
    assert at_seams("smooth") < 1.15
    assert at_seams("smooth") < at_seams("fast") - 0.05
    assert sampled("smooth").std() == pytest.approx(1, abs=0.08)
    assert sampled("fast").std() < 0.92
