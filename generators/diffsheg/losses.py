"""DiffSHEG's losses: the error of the noise, and the resulting error of the motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
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
        Weight of the loss of the motion's steps from frame to frame, equation 6.
    reconstruction : float
        Weight of Huber's loss of the motion, equation 7.
    turn : float
        Error of normalised values at which Huber's loss turns from square to straight, the
        paper's δ, of which it does not tell the value.
    slope : float or None
        Slope of its straight part: 1 in the release; None for `turn`, as in equation 7.
    semantic : bool
        Whether errors of the motion count (1 + score) times in frames that were annotated as
        meaningful, as in the release's training on BEAT.
    """

    noise: float
    velocity: float
    reconstruction: float
    turn: float = 0.1
    slope: float | None = None
    semantic: bool = False


LOSSES: Final[Mapping[str, LossWeights]] = MappingProxyType(
    {
        "paper": LossWeights(noise=10, velocity=1, reconstruction=1),
        "release": LossWeights(
            noise=1000, velocity=1, reconstruction=100, slope=1.0, semantic=True
        ),
        "steps": LossWeights(noise=1, velocity=10, reconstruction=1, turn=1.0),
    }
)
"""The paper's weights (equation 8), those of the released training, and a third for a network with
a skip. In it the motion counts as the noise does, with a Huber loss that turns at one deviation:
where most is noise, only the motion says what speech and speaker decide, and such a network is
nowhere so far off that it must count less there. Steps from frame to frame count ten times:
posture varies so much more than they do that little else would be learned."""


def motion_losses(
    noise: Tensor,
    predicted: Tensor,
    steps: Tensor,
    weights: LossWeights,
    semantic: Tensor | None = None,
) -> dict[str, Tensor]:
    """Return the loss of found noise, and its parts.

    Parameters
    ----------
    noise, predicted : Tensor
        (batch, frames, values): what was added to normalised motion, and what the network says.
    steps : Tensor
        (batch,) diffusion steps.
    weights : LossWeights
        Weights of the parts.
    semantic : Tensor, optional
        (batch, frames, 1), scores from 0 of how meaningful a frame's gesture is.

    Returns
    -------
    dict of str to Tensor
        ``loss``, the weighted sum of equation 8; ``noise``, ``velocity``, ``reconstruction``,
        unweighted means over frames and values.
    """
    alpha_bar = LINEAR.alpha_bar_at(steps, noise)
    error = (noise - predicted).float()
    # The clean motion that follows from the found noise (equation 5) misses the true one by this.
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
