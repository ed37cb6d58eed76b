"""What Speech2UnifiedExpressions learns by (section 5, equations 16 to 19)."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor
from torch.nn import functional

from generators.s2ue.config import LossWeights
from generators.s2ue.model import Network
from training.spaces.bone_tensors import joints_of, split_motion


def phoneme_loss(found: Tensor, true: Tensor, spread: Tensor) -> Tensor:
    """Return equation 16 of lips (B, T, lips, 3): their places and their steps."""
    return _distance(found, true, spread) + _distance(_steps(found), _steps(true), spread)


def reconstruction_losses(
    network: Network, found: Tensor, true: Tensor, weights: LossWeights
) -> dict[str, Tensor]:
    """Return equation 17 of values (B, T, 27 + 3 L), ``reconstruction``, and its parts.

    Landmarks are the neutral face and their shifts (equation 1), so that places of landmarks and
    shifts are equally far apart. What the network does not tell does not count.
    """
    config = network.config
    one, two = split_motion(found), split_motion(true)
    face, direction, joint = network.spread
    places, motions, steps = [], [], []
    if config.faces:
        places.append(_distance(one["face"], two["face"], face))
        motions.append(places[-1])
        steps.append(_distance(_steps(one["face"]), _steps(two["face"]), face))
    if config.poses:
        places.append(_distance(joints_of(one["pose"]), joints_of(two["pose"]), joint))
        motions.append(_distance(one["pose"], two["pose"], direction))
        steps.append(_distance(_steps(one["pose"]), _steps(two["pose"]), direction))
    parts = {"place": _sum(places), "velocity": _sum(motions), "acceleration": _sum(steps)}
    total = (
        parts["place"]
        + weights.velocity * parts["velocity"]
        + weights.acceleration * parts["acceleration"]
    )
    return {"reconstruction": total, **parts}


def diversity_loss(
    network: Network, own: Tensor, other: Tensor, true: Tensor, margin: float
) -> Tensor:
    """Return the cross-speaker ranking loss of section 5.2.2.

    Motion as the recorded speaker lies nearer to the recording than motion as another one, by a
    margin, each window for itself.
    """
    far = [
        (network.normalised(one) - network.normalised(true)).abs().mean(dim=(1, 2))
        for one in (own, other)
    ]
    return functional.relu(far[0] - far[1] + margin).mean()


def _sum(losses: Sequence[Tensor]) -> Tensor:
    """Return their sum."""
    return torch.stack(list(losses)).sum()


def _distance(found: Tensor, true: Tensor, spread: Tensor) -> Tensor:
    return (found - true).abs().mean() / spread


def _steps(values: Tensor) -> Tensor:
    """Return the differences of adjacent frames."""
    return values[:, 1:] - values[:, :-1]
