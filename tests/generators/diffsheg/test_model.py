"""Properties of the network for any weights."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor

from generators.diffsheg.config import DenoiserConfig, Flow
from generators.diffsheg.losses import LOSSES, motion_losses
from tests.generators.diffsheg.small_network import TINY, shaken
from training.diffusion import LINEAR

SMALL = replace(TINY, guidance=None, loudness="power", skip=False)
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


@pytest.mark.parametrize("guidance", [None, 1.3])
def test_a_window_gives_the_same_output_alone_and_in_a_batch(guidance: float | None) -> None:
    config = replace(SMALL, guidance=guidance)
    denoiser, question = shaken(config), asked(config, batch=3)
    together = denoiser(*question)
    for number in range(3):
        alone = denoiser(*(one[number : number + 1] for one in question))
        assert torch.allclose(alone[0], together[number], atol=1e-5)


GESTURE, EXPRESSION = slice(0, SMALL.gesture_width), slice(SMALL.gesture_width, None)


@pytest.mark.parametrize(
    ("part", "branch", "detached", "learns"),
    [
        (GESTURE, "gesture", True, True),
        (GESTURE, "expression", True, False),
        (GESTURE, "expression", False, True),
        (EXPRESSION, "gesture", False, False),
    ],
)
def test_body_errors_reach_the_face_only_without_the_gradient_cut(
    part: slice, branch: str, detached: bool, learns: bool
) -> None:
    config = replace(SMALL, detached=detached)
    denoiser = shaken(config)
    denoiser(*asked(config))[..., part].square().sum().backward()
    gradients = [weight.grad for weight in denoiser.branches[branch].parameters()]
    assert any(grad is not None and bool(grad.any()) for grad in gradients) == learns


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


def test_a_guided_network_drops_its_conditions_in_some_training_windows() -> None:
    config = replace(SMALL, guidance=1.2, dropout=0.0)
    denoiser = shaken(config).train()
    torch.manual_seed(0)
    denoiser(*asked(config, batch=40)).square().sum().backward()
    unconditioned = denoiser.get_parameter("branches.gesture.unconditioned")
    assert unconditioned.grad is not None
    assert unconditioned.grad.any()


STEPS = torch.tensor([0, 250, 500])


@pytest.mark.parametrize(
    ("name", "noise_weight", "reconstruction_weight", "slope"),
    [("paper", 10, 1, 0.1), ("release", 1000, 100, 1.0)],
)
def test_losses_are_equations_4_to_8_and_meaningful_frames_count_more_in_the_release(
    name: str, noise_weight: float, reconstruction_weight: float, slope: float
) -> None:
    random = torch.Generator().manual_seed(4)
    clean, noise, mistaken = (torch.randn(3, 5, 2, generator=random) for _ in range(3))
    predicted = noise + 0.1 * mistaken
    noisy = LINEAR.x_t(clean, noise, STEPS)
    estimate = LINEAR.x0_hat(noisy, predicted, STEPS).double().numpy()
    true = clean.double().numpy()
    semantic = torch.rand(3, 5, 1, generator=random)
    counted = 1 + semantic.numpy() if name == "release" else 1
    missed = np.abs(true - estimate) * counted
    expected = {
        "noise": float((noise - predicted).square().mean()),
        "velocity": np.mean((np.diff(true, axis=1) - np.diff(estimate, axis=1)) ** 2),
        "reconstruction": np.mean(np.where(missed < 0.1, missed**2 / 0.2, missed - 0.05) * slope),
    }
    expected["loss"] = (
        noise_weight * expected["noise"]
        + expected["velocity"]
        + reconstruction_weight * expected["reconstruction"]
    )
    losses = motion_losses(noise, predicted, STEPS, LOSSES[name], semantic)
    assert {key: float(value) for key, value in losses.items()} == pytest.approx(expected, rel=1e-4)
