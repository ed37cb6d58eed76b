"""DiffSHEG's losses: the error of the noise, and the resulting error of the motion."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import torch
from torch import Tensor
from torch.nn import functional

from training.diffusion import LINEAR


@dataclass(frozen=True, kw_only=True)
class LossWeights:
    """Weights of the parts.

    Attributes
    ----------
    noise : float
        Weight of the loss of the noise, equation 4.
    velocity : float
        Weight of the loss of the motion's change from frame to frame, equation 6.
    reconstruction : float
        Weight of the Huber loss of the motion, equation 7.
    turn : float
        Error of normalised values at which the Huber loss becomes linear, the paper's δ, whose
        value it does not give.
    slope : float or None
        Slope of the linear part: 1 in the release; None for `turn`, as in equation 7.
    semantic : bool
        Whether errors of the motion are multiplied by (1 + score) in frames that were annotated as
        meaningful, as in the release's training on BEAT.
    """

    noise: float
    velocity: float
    reconstruction: float
    turn: float = 0.1
    slope: float | None = None
    semantic: bool = False


LOSSES: Final[Mapping[str, LossWeights]] = {
    "paper": LossWeights(noise=10, velocity=1, reconstruction=1),
    "release": LossWeights(noise=1000, velocity=1, reconstruction=100, slope=1.0, semantic=True),
    "steps": LossWeights(noise=1, velocity=10, reconstruction=1, turn=1.0),
}
"""The paper's weights (equation 8), those of the released training, and a third set for a network
with a skip. There, motion counts as much as noise, with a Huber loss that becomes linear at one
standard deviation: at noisy steps, only the motion shows the effect of speech and speaker, and such
a network's errors are never so large that they must count less. Changes from frame to frame count
ten times: posture varies so much more that little else would be learned."""


def motion_losses(
    noise: Tensor,
    predicted: Tensor,
    steps: Tensor,
    weights: LossWeights,
    semantic: Tensor | None = None,
) -> dict[str, Tensor]:
    """Return the loss of predicted noise, and its parts.

    Parameters
    ----------
    noise, predicted : Tensor
        (batch, frames, values): the noise in normalised motion, and the network's prediction.
    steps : Tensor
        (batch,) diffusion steps.
    weights : LossWeights
        Weights of the parts.
    semantic : Tensor, optional
        (batch, frames, 1), semantic score of each frame's gesture, at least 0.

    Returns
    -------
    dict of str to Tensor
        ``loss``, the weighted sum of equation 8; ``noise``, ``velocity``, ``reconstruction``,
        unweighted means over frames and values.
    """
    alpha_bar = LINEAR.alpha_bar_at(steps, noise)
    error = (noise - predicted).float()
    # The error of the clean motion that follows from the predicted noise (equation 5).
    motion_error = error * ((1 - alpha_bar) / alpha_bar).sqrt()
    weighted = (
        motion_error if semantic is None or not weights.semantic else motion_error * (1 + semantic)
    )
    huber = functional.huber_loss(
        weighted, torch.zeros_like(weighted), delta=weights.turn, reduction="none"
    )
    if weights.slope is not None:
        huber = huber * (weights.slope / weights.turn)
    parts = {
        "noise": error.square().mean(),
        "velocity": (motion_error[:, 1:] - motion_error[:, :-1]).square().mean(),
        "reconstruction": huber.mean(),
    }
    total = (
        weights.noise * parts["noise"]
        + weights.velocity * parts["velocity"]
        + weights.reconstruction * parts["reconstruction"]
    )
    return {"loss": total, **parts}
