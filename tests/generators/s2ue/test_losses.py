"""Losses are the paper's equations."""

from __future__ import annotations

import math

import pytest
import torch

from generators.s2ue.config import LossWeights
from generators.s2ue.losses import (
    discriminator_loss,
    diversity_loss,
    generator_loss,
    phoneme_loss,
    reconstruction_losses,
)
from tests.generators.s2ue.small_network import FACE, small_network
from training.spaces.bones_and_landmarks import joint_tensors_of

VALUES = 27 + 3 * FACE.count
WEIGHTS = LossWeights(velocity=2.0, acceleration=3.0)


def motion(seed: int) -> torch.Tensor:
    return torch.randn(2, 5, VALUES, generator=torch.Generator().manual_seed(seed))


def test_equation_16_counts_places_and_steps() -> None:
    true = torch.zeros(1, 3, 2, 3)
    found = true.clone()
    found[:, 1] = 0.5
    # A third of the frames is off by 0.5; both steps are.
    assert float(phoneme_loss(found, true, torch.tensor(0.1))) == pytest.approx(
        (0.5 / 3 + 0.5) / 0.1
    )


def test_equation_17_counts_places_motions_and_their_steps() -> None:
    network = small_network()
    network.spread.copy_(torch.tensor([1e-3, 0.5, 0.1]))
    one, two = motion(1), motion(2)
    found = reconstruction_losses(network, one, two, WEIGHTS)
    pose, face = one[..., :27] - two[..., :27], one[..., 27:] - two[..., 27:]
    joints = joint_tensors_of(one[..., :27].reshape(2, 5, 9, 3)) - joint_tensors_of(
        two[..., :27].reshape(2, 5, 9, 3)
    )
    places = face.abs().mean() / 1e-3 + joints.abs().mean() / 0.1
    motions = face.abs().mean() / 1e-3 + pose.abs().mean() / 0.5
    steps = face.diff(dim=1).abs().mean() / 1e-3 + pose.diff(dim=1).abs().mean() / 0.5
    assert float(found["reconstruction"]) == pytest.approx(
        float(places + 2 * motions + 3 * steps), rel=1e-5
    )
    plain = reconstruction_losses(network, one, two, LossWeights(velocity=0, acceleration=0))
    assert float(plain["reconstruction"]) == pytest.approx(float(places), rel=1e-5)
    assert float(reconstruction_losses(network, one, one, WEIGHTS)["reconstruction"]) == 0


@pytest.mark.parametrize(("left_out", "values"), [("faces", slice(27, None)), ("poses", slice(27))])
def test_what_is_not_told_does_not_count(left_out: str, values: slice) -> None:
    network = small_network(**{left_out: False})
    one, two = motion(1), motion(1)
    two[..., values] += 1
    assert float(reconstruction_losses(network, one, two, WEIGHTS)["reconstruction"]) == 0


def test_another_speakers_motion_is_to_be_further_away() -> None:
    network = small_network()
    true = network.mean.expand(1, 5, VALUES)
    near, far = true + 0.1 * network.deviation, true + 0.3 * network.deviation
    assert float(diversity_loss(network, near, far, true, 0.1)) == 0
    assert float(diversity_loss(network, far, near, true, 0.1)) == pytest.approx(0.3, abs=1e-5)
    assert float(diversity_loss(network, near, near, true, 0.1)) == pytest.approx(0.1, abs=1e-5)


def test_equations_18_and_19_are_logarithms_of_probabilities() -> None:
    recorded, synthesised = torch.tensor([[1.0]]), torch.tensor([[-2.0]])
    real, fake = (1 / (1 + math.exp(-float(one))) for one in (recorded, synthesised))
    assert float(generator_loss(synthesised)) == pytest.approx(-math.log(fake))
    assert float(discriminator_loss(recorded, synthesised)) == pytest.approx(
        -math.log(real) - math.log(1 - fake)
    )
