"""Losses of generator and discriminator are logarithms of probabilities."""

from __future__ import annotations

import math

import pytest
import torch

from training.layers.adversarial import discriminator_loss, generator_loss


def test_equations_18_and_19_are_logarithms_of_probabilities() -> None:
    recorded, synthesised = torch.tensor([[1.0]]), torch.tensor([[-2.0]])
    real, fake = (1 / (1 + math.exp(-float(one))) for one in (recorded, synthesised))
    assert float(generator_loss(synthesised)) == pytest.approx(-math.log(fake))
    assert float(discriminator_loss(recorded, synthesised)) == pytest.approx(
        -math.log(real) - math.log(1 - fake)
    )
