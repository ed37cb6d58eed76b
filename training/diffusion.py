"""Diffusion: how much noise each step holds, and the way back.

Ho et al. 2020 (DDPM) and Song et al. 2021 (DDIM). Both formulas and the schedule are so short, and
so much depends on which step of a resampled walk is next, that they stand here; tests hold them
against an independent derivation.
"""

from __future__ import annotations

import math
from typing import Final

import torch
from torch import Tensor

from training.noise_schedule import NoiseSchedule


class LinearSchedule(NoiseSchedule):
    """Noise that grows linearly from step to step, put into motion and taken out of it."""

    def x_t(self, x0: Tensor, eps: Tensor, t: Tensor) -> Tensor:
        """Return the clean motion `x0` with noise `eps` at diffusion steps `t`."""
        alpha_bar = self.alpha_bar_at(t, x0)
        return alpha_bar.sqrt() * x0 + (1 - alpha_bar).sqrt() * eps

    def x0_hat(self, x_t: Tensor, eps: Tensor, t: Tensor) -> Tensor:
        """Return the clean motion of which `x_t` is left where `eps` is its noise."""
        alpha_bar = self.alpha_bar_at(t, x_t)
        return (x_t - (1 - alpha_bar).sqrt() * eps) / alpha_bar.sqrt()

    def alpha_bar_at(self, t: Tensor, motion: Tensor) -> Tensor:
        """Return `alpha_bar` at each of the steps `t`, to be multiplied with `motion`."""
        alpha_bar = torch.as_tensor(self.alpha_bar, dtype=torch.float32, device=motion.device)[t]
        return alpha_bar.reshape(-1, *([1] * (motion.ndim - 1)))


LINEAR: Final = LinearSchedule()
"""The schedule of DDPM and of DiffSHEG."""


def step_embedding(t: Tensor, width: int) -> Tensor:
    """Return cosines and sines of diffusion steps, (batch, width).

    Frequencies fall from 1 to 1/10000 (Vaswani et al. 2017, section 3.5).
    """
    half = width // 2
    falling = torch.arange(half, dtype=torch.float32, device=t.device) / half
    angles = t[:, None].float() * torch.exp(-math.log(10_000) * falling)
    return torch.cat([angles.cos(), angles.sin()], dim=-1)
