"""Losses of Speech2UnifiedExpressions (section 5, equations 16 to 19)."""

import torch
from torch import Tensor
from torch.nn import functional

from generators.s2ue.config import LossWeights
from generators.s2ue.model import Network
from training.spaces.bones_and_landmarks import joint_tensors, split_motion


def phoneme_loss(output: Tensor, target: Tensor, spread: Tensor) -> Tensor:
    """Return equation 16 of lips (B, T, lips, 3): errors of positions and of their changes."""
    error = (output - target) / spread
    return error.abs().mean() + error.diff(dim=1).abs().mean()


def reconstruction_losses(
    network: Network, output: Tensor, target: Tensor, weights: LossWeights
) -> dict[str, Tensor]:
    """Return equation 17 of values (B, T, 27 + 3 L) as ``reconstruction``, and its parts.

    Landmarks are the neutral face plus shifts (equation 1), so distances of landmarks equal
    distances of shifts. Modalities that the network does not generate do not count.
    """
    outputs, targets = split_motion(output), split_motion(target)
    spread = dict(zip(("face", "pose", "joints"), network.spread, strict=True))
    parts = dict.fromkeys(("place", "velocity", "acceleration"), output.new_zeros(()))
    for name in (modality for modalities in network.config.modalities for modality in modalities):
        error = (outputs[name] - targets[name]) / spread[name]
        motion = error.abs().mean()
        place = motion
        if name == "pose":
            joints = joint_tensors(outputs[name]) - joint_tensors(targets[name])
            place = joints.abs().mean() / spread["joints"]
        parts["place"] = parts["place"] + place
        parts["velocity"] = parts["velocity"] + motion
        parts["acceleration"] = parts["acceleration"] + error.diff(dim=1).abs().mean()
    counted = {"place": 1.0, "velocity": weights.velocity, "acceleration": weights.acceleration}
    total = torch.stack([weight * parts[name] for name, weight in counted.items()]).sum()
    return {"reconstruction": total, **parts}


def diversity_loss(
    network: Network, own_motion: Tensor, other_motion: Tensor, target: Tensor, margin: float
) -> Tensor:
    """Return the cross-speaker ranking loss of section 5.2.2.

    In each window, motion as the recorded speaker should be nearer to the recording than motion as
    another speaker, by a margin.
    """
    distances = [
        (network.normalised(motion) - network.normalised(target)).abs().mean(dim=(1, 2))
        for motion in (own_motion, other_motion)
    ]
    return functional.relu(distances[0] - distances[1] + margin).mean()


def generator_loss(synthesised: Tensor) -> Tensor:
    """Return -log c from the logits of synthesised motion."""
    return functional.softplus(-synthesised).mean()


def discriminator_loss(recorded: Tensor, synthesised: Tensor) -> Tensor:
    """Return -log c of recorded plus -log(1 - c) of synthesised motion, from logits."""
    return functional.softplus(-recorded).mean() + functional.softplus(synthesised).mean()
