"""Motion of any length, in one go or as the speech comes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from generators.diffsheg.config import TINY
from generators.diffsheg.model import Denoiser
from generators.diffsheg.sampling import (
    Estimate,
    Sampler,
    WindowSampler,
    draw_noise,
    sample_window,
    stream,
)
from generators.diffsheg.settings import Sampling
from motion.errors import InputError
from training.diffusion import LINEAR
from training.hearing.speech_frames import SpeechFrames

SMALL = replace(
    TINY,
    gesture_width=4,
    expression_width=2,
    speakers=2,
    width=16,
    feed_forward=16,
    heads=2,
    speech_features=8,
    audio_width=8,
    frames=8,
)
SAMPLING = Sampling(overlap=3)
WIDTH, FRAMES = SMALL.motion_width, SMALL.frames


def spoken(frames: int) -> SpeechFrames:
    random = torch.Generator().manual_seed(3)
    return SpeechFrames(
        torch.rand(frames, SMALL.audio_width, generator=random),
        torch.randn(frames, SMALL.speech_features, generator=random),
    )


def network() -> Denoiser:
    torch.manual_seed(5)
    denoiser = Denoiser(SMALL).eval().requires_grad_(False)
    for weight in denoiser.parameters():
        weight.add_(0.05 * torch.randn_like(weight))
    return denoiser


NETWORK = network()
PERSON = torch.tensor([0.0, 1.0])
SAMPLER = WindowSampler(NETWORK, PERSON, SAMPLING)


def moved(pieces: list[SpeechFrames], sampler: Sampler = SAMPLER, seed: int = 1) -> Tensor:
    settled = stream(pieces, sampler, frames=FRAMES, width=WIDTH, sampling=SAMPLING, seed=seed)
    return torch.cat([torch.empty(0, WIDTH), *settled])


@settings(max_examples=8, deadline=None)
@given(st.lists(st.integers(1, 9), min_size=1, max_size=8))
def test_how_speech_comes_in_changes_nothing(lengths: list[int]) -> None:
    whole = spoken(sum(lengths))
    ends = np.cumsum(lengths)
    pieces = [
        whole.part(end - length, end) for length, end in zip(lengths, map(int, ends), strict=True)
    ]
    assert torch.equal(moved(pieces), moved([whole]))


def test_windows_that_share_nothing_are_the_same_alone_and_together() -> None:
    apart = replace(SAMPLING, overlap=0)
    sampler, whole = WindowSampler(NETWORK, PERSON, apart), spoken(3 * FRAMES + 2)
    pieces = [whole.part(start, start + FRAMES) for start in range(0, len(whole), FRAMES)]
    one_by_one, together = (
        torch.cat(list(stream(given, sampler, frames=FRAMES, width=WIDTH, sampling=apart, seed=1)))
        for given in (pieces, [whole])
    )
    assert torch.equal(one_by_one, together)


@pytest.mark.parametrize("frames", [1, 2, 3, 7, 8, 9, 11, 13, 14, 30])
def test_motion_is_as_long_as_the_speech(frames: int) -> None:
    assert moved([spoken(frames)]).shape == (frames, WIDTH)


def test_nothing_said_gives_no_motion() -> None:
    assert len(moved([])) == 0


def test_motion_comes_before_the_speech_has_ended() -> None:
    asked: list[int] = []

    def pieces() -> object:
        for number in range(4):
            asked.append(number)
            yield spoken(FRAMES)

    settled = stream(
        pieces(),  # type: ignore[arg-type]
        SAMPLER,
        frames=FRAMES,
        width=WIDTH,
        sampling=SAMPLING,
        seed=1,
    )
    assert len(next(settled)) == FRAMES - SAMPLING.overlap
    assert asked == [0]


def test_seeds_decide_the_motion() -> None:
    assert torch.equal(moved([spoken(20)], seed=2), moved([spoken(20)], seed=2))
    assert not torch.equal(moved([spoken(20)], seed=2), moved([spoken(20)], seed=3))


def test_windows_that_share_all_their_frames_are_refused() -> None:
    sampling = replace(SAMPLING, overlap=FRAMES)
    with pytest.raises(InputError, match="cannot share 8"):
        next(stream([spoken(9)], SAMPLER, frames=FRAMES, width=WIDTH, sampling=sampling, seed=1))


MEAN, SPREAD = 2.0, 0.5


def _of_a_normal_law(sampling: Sampling) -> Estimate:
    """Return the perfect network for motion whose values are all normal and independent."""

    def estimate(noisy: Tensor, place: int) -> Tensor:
        kept = float(LINEAR.alpha_bar[sampling.timesteps[place]])
        variance = kept * SPREAD**2 + 1 - kept
        return (noisy - kept**0.5 * MEAN) * (1 - kept) ** 0.5 / variance

    return estimate


@pytest.mark.parametrize("jump_count", [1, 2, 5])
def test_a_perfect_network_is_sampled_nearly_from_its_law_in_the_frames_that_are_new(
    jump_count: int,
) -> None:
    """Few steps without noise of their own, walked again and again, narrow the law a little."""
    sampling = Sampling(overlap=4, entry=25, jump_count=jump_count)
    known = torch.full((4, 3000), 1.0)
    random = torch.Generator().manual_seed(2)
    noise = draw_noise((6, 3000), sampling, random, continues=True)
    motion = sample_window(_of_a_normal_law(sampling), sampling, noise, known)
    new = motion[4:]
    assert float(new.mean()) == pytest.approx(MEAN, abs=0.05)
    assert float(new.std()) == pytest.approx(SPREAD, rel=0.2)


def test_shared_frames_lead_from_the_window_before_into_the_new_one() -> None:
    known = torch.full((4, 3000), -1.0)
    random = torch.Generator().manual_seed(2)
    sampling = Sampling(overlap=4)
    noise = draw_noise((8, 3000), sampling, random, continues=True)
    motion = sample_window(_of_a_normal_law(sampling), sampling, noise, known)
    means = motion.mean(dim=1)
    assert float((motion[0] - known[0]).abs().max()) < 1e-5
    assert (means[1:5] > means[:4]).all()
