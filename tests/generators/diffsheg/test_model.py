"""Properties of the network for any weights."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor

from generators.diffsheg.config import BEAT, FLOWS, PRESETS, DenoiserConfig, Flow
from generators.diffsheg.losses import LOSSES, LossWeights, motion_losses
from generators.diffsheg.model import Denoiser
from motion.errors import InputError
from tests.generators.diffsheg.small_network import shaken
from training.diffusion import LINEAR

SMALL = replace(
    PRESETS["tiny"]["beat"].network,
    gesture_width=6,
    expression_width=4,
    speakers=3,
    width=16,
    feed_forward=24,
    heads=2,
    guidance=None,
    loudness="power",
    skip=False,
)
FRAMES = 9


def asked(config: DenoiserConfig, batch: int = 2, frames: int = FRAMES) -> tuple[Tensor, ...]:
    random = torch.Generator().manual_seed(7)
    return (
        torch.randn(batch, frames, config.motion_width, generator=random),
        torch.randint(0, 1000, (batch,), generator=random),
        torch.rand(batch, frames, config.audio_width, generator=random),
        torch.randn(batch, frames, config.speech_features, generator=random),
        torch.eye(config.speakers)[torch.arange(batch) % config.speakers],
    )


@pytest.mark.parametrize("flow", FLOWS)
def test_a_network_with_a_skip_that_learned_nothing_takes_the_motion_for_noise(flow: Flow) -> None:
    question = asked(replace(SMALL, flow=flow, skip=True))
    noisy, steps = question[:2]
    result = Denoiser(replace(SMALL, flow=flow, skip=True)).eval()(*question)
    kept = torch.tensor(LINEAR.alpha_bar[steps], dtype=torch.float32)[:, None, None]
    assert torch.allclose(result, (1 - kept).sqrt() * noisy, atol=1e-6)


def test_the_logarithm_of_mel_bands_is_read_from_silence_at_minus_one() -> None:
    question = list(asked(SMALL))
    question[2] = question[2] * torch.logspace(-6, 3, SMALL.audio_width)
    question[2][:, 0] = 0.0
    heard = shaken(replace(SMALL, loudness="logarithm"))(*question)
    question[2] = (torch.log10(question[2] + 1e-4) + 2) / 2
    assert torch.all(question[2][:, 0] == -1)
    assert torch.allclose(shaken(SMALL)(*question), heard, atol=1e-5)


@pytest.mark.parametrize("guidance", [None, 1.3])
def test_a_window_gets_the_same_answer_alone_and_in_a_batch(guidance: float | None) -> None:
    config = replace(SMALL, guidance=guidance)
    denoiser, question = shaken(config), asked(config, batch=3)
    together = denoiser(*question)
    for number in range(3):
        alone = denoiser(*(one[number : number + 1] for one in question))
        assert torch.allclose(alone[0], together[number], atol=1e-5)


def _learns(config: DenoiserConfig, branch: str, part: slice) -> bool:
    """Return whether an error in `part` of the estimate changes the weights of `branch`."""
    denoiser = shaken(config)
    denoiser(*asked(config))[..., part].square().sum().backward()
    return any(
        weight.grad is not None and bool(weight.grad.any())
        for weight in denoiser.branches[branch].parameters()
    )


GESTURE, EXPRESSION = slice(0, SMALL.gesture_width), slice(SMALL.gesture_width, None)


def test_the_face_learns_nothing_from_errors_of_the_body() -> None:
    assert not _learns(SMALL, "expression", GESTURE)
    assert _learns(SMALL, "gesture", GESTURE)


def test_without_the_cut_the_face_learns_from_errors_of_the_body() -> None:
    assert _learns(replace(SMALL, detached=False), "expression", GESTURE)


def test_the_body_never_learns_from_errors_of_the_face() -> None:
    assert not _learns(replace(SMALL, detached=False), "gesture", EXPRESSION)


@pytest.mark.parametrize(
    ("flow", "body_follows", "face_follows"),
    [
        ("expression_to_gesture", True, False),
        ("gesture_to_expression", False, True),
        ("none", False, False),
        ("joint", True, True),
    ],
)
def test_the_parts_depend_on_each_other_as_configured(
    flow: Flow, body_follows: bool, face_follows: bool
) -> None:
    denoiser = shaken(replace(SMALL, flow=flow))
    noisy, *conditions = asked(SMALL)
    before = denoiser(noisy, *conditions)

    def changed(moved: slice, seen: slice) -> bool:
        other = noisy.clone()
        other[..., moved] += 1
        return not torch.equal(denoiser(other, *conditions)[..., seen], before[..., seen])

    assert changed(EXPRESSION, GESTURE) == body_follows
    assert changed(GESTURE, EXPRESSION) == face_follows


def test_a_guided_network_forgets_its_conditions_in_some_windows_while_it_learns() -> None:
    config = replace(SMALL, guidance=1.2, dropout=0.0)
    denoiser = shaken(config).train()
    torch.manual_seed(0)
    denoiser(*asked(config, batch=40)).square().sum().backward()
    unconditioned = denoiser.get_parameter("branches.gesture.unconditioned")
    assert unconditioned.grad is not None
    assert unconditioned.grad.any()


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"heads": 3}, "heads do not divide"),
        ({"frames": 5000}, "longer than the 1200 positions"),
        ({"dropout": 1.0}, "dropout"),
        ({"gesture_width": 0}, "gesture_width is 0"),
        ({"frame_rate": 0.0}, "frame rate"),
        ({"flow": "both"}, "no flow 'both'"),
    ],
)
def test_a_network_that_cannot_be_built_is_refused(wrong: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        replace(SMALL, **wrong)  # type: ignore[arg-type]  # wrong on purpose


def test_the_released_size_has_the_papers_weights() -> None:
    with torch.device("meta"):
        denoiser = Denoiser(BEAT)
    count = sum(weight.numel() for weight in denoiser.parameters())
    assert count == pytest.approx(155.4e6, rel=1e-3)


STEPS = torch.tensor([0, 250, 500])


@pytest.fixture
def windows() -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Return clean motion, noise and a prediction, three windows of two values."""
    random = torch.Generator().manual_seed(4)
    clean, noise, mistaken = (torch.randn(3, 5, 2, generator=random) for _ in range(3))
    return clean, noise, noise + 0.1 * mistaken


def told_losses(noise: torch.Tensor, found: torch.Tensor, name: str = "paper") -> dict[str, float]:
    losses = motion_losses(noise, found, STEPS, LOSSES[name])
    return {name: float(value) for name, value in losses.items()}


def test_velocity_and_reconstruction_are_those_of_the_motion_that_follows_from_the_noise(
    windows: tuple[torch.Tensor, torch.Tensor, torch.Tensor],
) -> None:
    clean, noise, result = windows
    noisy = LINEAR.x_t(clean, noise, STEPS)
    estimate = LINEAR.x0_hat(noisy, result, STEPS).double().numpy()
    true = clean.double().numpy()
    velocity = np.mean((np.diff(true, axis=1) - np.diff(estimate, axis=1)) ** 2)
    missed = np.abs(true - estimate)
    huber = np.mean(np.where(missed < 0.1, missed**2 / 2, 0.1 * (missed - 0.05)))
    losses = told_losses(noise, result)
    assert losses["noise"] == pytest.approx(float((noise - result).square().mean()))
    assert losses["velocity"] == pytest.approx(velocity, rel=1e-4)
    assert losses["reconstruction"] == pytest.approx(huber, rel=1e-4)


def test_the_paper_weighs_ten_to_one_to_one(
    windows: tuple[torch.Tensor, torch.Tensor, torch.Tensor],
) -> None:
    _, noise, result = windows
    losses = told_losses(noise, result)
    expected = 10 * losses["noise"] + losses["velocity"] + losses["reconstruction"]
    assert losses["loss"] == pytest.approx(expected)


def test_the_release_weighs_a_thousand_to_one_to_a_hundred_of_a_steeper_huber(
    windows: tuple[torch.Tensor, torch.Tensor, torch.Tensor],
) -> None:
    _, noise, result = windows
    papers, losses = told_losses(noise, result), told_losses(noise, result, "release")
    assert losses["reconstruction"] == pytest.approx(10 * papers["reconstruction"])
    expected = 1000 * losses["noise"] + losses["velocity"] + 100 * losses["reconstruction"]
    assert losses["loss"] == pytest.approx(expected)


def test_errors_in_meaningful_frames_count_more_where_the_weights_say_so() -> None:
    noise, semantic = torch.zeros(1, 4, 2), torch.zeros(1, 4, 1)
    semantic[0, 1] = 1.0
    steps = torch.tensor([300])

    def reconstruction(frame: int, weights: LossWeights) -> float:
        result = noise.clone()
        result[0, frame] = 10.0
        return float(motion_losses(noise, result, steps, weights, semantic)["reconstruction"])

    plain, counted = LOSSES["paper"], replace(LOSSES["paper"], semantic=True)
    assert reconstruction(1, plain) == reconstruction(2, plain)
    assert reconstruction(1, counted) == pytest.approx(2 * reconstruction(2, counted), rel=0.01)
