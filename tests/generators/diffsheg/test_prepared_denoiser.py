"""The network with everything prepared moves as the plain one does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
import torch
from torch import Tensor

from generators.diffsheg.config import FLOWS, TINY, DenoiserConfig, Flow
from generators.diffsheg.denoiser import Denoiser
from generators.diffsheg.estimates import Mover, plainly, prepared
from generators.diffsheg.foppas import stream
from generators.diffsheg.prepared_branch import PreparedBranch
from generators.diffsheg.shared_threads import torch_threads
from generators.diffsheg.speech_frames import SpeechFrames
from generators.diffsheg.walk import Sampling

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


def moved(mover: Mover, frames: int = 24) -> Tensor:
    random = torch.Generator().manual_seed(3)
    speech = SpeechFrames(
        5 * torch.rand(frames, SMALL.audio_width, generator=random),
        torch.randn(frames, SMALL.speech_features, generator=random),
    )
    width = SMALL.motion_width
    pieces = stream([speech], mover, frames=SMALL.frames, width=width, sampling=SAMPLING, seed=1)
    return torch.cat(list(pieces))


@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize(("guidance", "skip"), [(None, False), (1.3, True)])
@pytest.mark.parametrize("flow", FLOWS)
def test_the_motion_is_that_of_the_plain_network(
    flow: Flow, guidance: float | None, skip: bool, number: int
) -> None:
    denoiser = shaken(replace(SMALL, flow=flow, guidance=guidance, skip=skip))
    plain = moved(plainly(denoiser, PERSON, SAMPLING))
    with torch_threads(number):
        found = moved(prepared(denoiser, PERSON, SAMPLING))
    assert float((found - plain).abs().max()) < 1e-4 * float(plain.abs().max())


def test_branches_beside_each_other_give_the_same_bits_every_time() -> None:
    mover = prepared(shaken(SMALL), PERSON, SAMPLING)
    with torch_threads(2):
        first = moved(mover)
        assert all(torch.equal(moved(mover), first) for _ in range(3))


def test_speakers_are_told_apart() -> None:
    denoiser = shaken(SMALL)
    other = prepared(denoiser, PERSON.roll(1), SAMPLING)
    assert not torch.equal(moved(other), moved(prepared(denoiser, PERSON, SAMPLING)))


@pytest.mark.parametrize("number", [1, 2])
def test_what_stops_the_branch_ahead_is_told_at_once(
    number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    mover, answer = prepared(shaken(SMALL), PERSON, SAMPLING), PreparedBranch.answer

    def failing(self: PreparedBranch, noisy: Tensor, place: int, conditions: object) -> Tensor:
        if noisy.shape[-1] == SMALL.expression_width and place == 1:
            raise MemoryError("no memory for the face")
        return answer(self, noisy, place, conditions)  # type: ignore[arg-type]

    monkeypatch.setattr(PreparedBranch, "answer", failing)
    with torch_threads(number), pytest.raises(MemoryError, match="for the face"):
        moved(mover)


@pytest.mark.parametrize("way", [plainly, prepared])
def test_everything_happens_where_the_network_is(way: Callable[..., Mover]) -> None:
    """Values on 'meta' are not computed, but may not meet values that are elsewhere."""
    denoiser = shaken(replace(SMALL, guidance=1.3, layers=1)).to("meta")
    assert moved(way(denoiser, PERSON, SAMPLING)).device.type == "meta"
