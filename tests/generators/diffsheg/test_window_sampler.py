"""What is computed once for many evaluations moves as the whole network asked each time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import pytest
import torch
from torch import Tensor

from generators.diffsheg.config import BEAT, FLOWS, TINY, DenoiserConfig, Flow
from generators.diffsheg.model import Branch, Denoiser
from generators.diffsheg.sampling import (
    Sampler,
    Window,
    WindowSampler,
    sample_windows,
    stream,
)
from generators.diffsheg.settings import Sampling
from training.hearing.speech_frames import SpeechFrames
from training.threads import torch_threads

SMALL = replace(
    TINY,
    gesture_width=6,
    expression_width=4,
    speakers=3,
    width=16,
    feed_forward=24,
    heads=2,
    speech_features=8,
    audio_width=8,
    frames=8,
)
SAMPLING = Sampling(steps=5, entry=3, jump_length=2, overlap=3)
PERSON = torch.tensor([0.0, 1.0, 0.0])


def shaken(config: DenoiserConfig) -> Denoiser:
    """Return a network whose weights are all random, also those that start at zero or one."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(4)
        denoiser = Denoiser(config).eval().requires_grad_(False)
        for weight in denoiser.parameters():
            weight.add_(0.2 * torch.randn_like(weight))
    return denoiser


def asked_in_full(denoiser: Denoiser) -> Sampler:
    """Return what asks the whole network at each evaluation."""

    def eps(x_t: Tensor, place: int, speech: SpeechFrames) -> Tensor:
        t = torch.tensor([SAMPLING.timesteps[place]])
        found: Tensor = denoiser(x_t, t, speech.mel[None], speech.hubert[None], PERSON[None])
        return found

    def sample(windows: Sequence[Window], known: Tensor | None) -> list[Tensor]:
        asked = ((partial(eps, speech=window.speech), window.noise) for window in windows)
        return sample_windows(asked, SAMPLING, known)

    return sample


def moved(sampler: Sampler, frames: int = 24) -> Tensor:
    random = torch.Generator().manual_seed(3)
    speech = SpeechFrames(
        5 * torch.rand(frames, SMALL.audio_width, generator=random),
        torch.randn(frames, SMALL.speech_features, generator=random),
    )
    width = SMALL.motion_width
    pieces = stream([speech], sampler, frames=SMALL.frames, width=width, sampling=SAMPLING, seed=1)
    return torch.cat(list(pieces))


@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize(("guidance", "skip"), [(None, False), (1.3, True)])
@pytest.mark.parametrize("flow", FLOWS)
def test_the_motion_is_that_of_the_plain_network(
    flow: Flow, guidance: float | None, skip: bool, number: int
) -> None:
    denoiser = shaken(replace(SMALL, flow=flow, guidance=guidance, skip=skip))
    plain = moved(asked_in_full(denoiser))
    with torch_threads(number):
        found = moved(WindowSampler(denoiser, PERSON, SAMPLING))
    assert float((found - plain).abs().max()) < 1e-4 * float(plain.abs().max())


def test_branches_beside_each_other_give_the_same_bits_every_time() -> None:
    sampler = WindowSampler(shaken(SMALL), PERSON, SAMPLING)
    with torch_threads(2):
        first = moved(sampler)
        assert all(torch.equal(moved(sampler), first) for _ in range(3))


def test_speakers_are_told_apart() -> None:
    denoiser = shaken(SMALL)
    other = WindowSampler(denoiser, PERSON.roll(1), SAMPLING)
    assert not torch.equal(moved(other), moved(WindowSampler(denoiser, PERSON, SAMPLING)))


@pytest.mark.parametrize("number", [1, 2])
def test_what_stops_the_branch_ahead_is_told_at_once(
    number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    sampler, forward = WindowSampler(shaken(SMALL), PERSON, SAMPLING), Branch.forward

    def failing(self: Branch, x_t: Tensor, t: Tensor, *given: object) -> Tensor:
        if x_t.shape[-1] == SMALL.expression_width and int(t) == SAMPLING.timesteps[1]:
            raise MemoryError("no memory for the face")
        return forward(self, x_t, t, *given)  # type: ignore[arg-type]

    monkeypatch.setattr(Branch, "forward", failing)
    with torch_threads(number), pytest.raises(MemoryError, match="for the face"):
        moved(sampler)


def test_everything_happens_where_the_network_is() -> None:
    """Values on 'meta' are not computed, but may not meet values that are elsewhere."""
    denoiser = shaken(replace(SMALL, guidance=1.3, layers=1)).to("meta")
    assert moved(WindowSampler(denoiser, PERSON, SAMPLING)).device.type == "meta"


def test_the_released_size_has_the_papers_weights() -> None:
    with torch.device("meta"):
        denoiser = Denoiser(BEAT)
    assert sum(weight.numel() for weight in denoiser.parameters()) == pytest.approx(
        155.4e6, rel=1e-3
    )
