"""Losses of a generator and of the discriminator that tells its motion from recordings."""

from __future__ import annotations

from torch import Tensor
from torch.nn import functional


def generator_loss(synthesised: Tensor) -> Tensor:
    """Return -log c of the logits of synthesised motion."""
    return functional.softplus(-synthesised).mean()


def discriminator_loss(recorded: Tensor, synthesised: Tensor) -> Tensor:
    """Return, of logits, -log c of recorded, -log(1 - c) of synthesised motion."""
    return functional.softplus(-recorded).mean() + functional.softplus(synthesised).mean()
