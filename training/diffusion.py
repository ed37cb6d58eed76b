"""Diffusion: the noise schedule, adding noise and removing it.

Ho et al. 2020 (DDPM) and Song et al. 2021 (DDIM). The formulas are short and depend on the order of
the resampled steps, so they are implemented here; tests compare them with an independent
derivation.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import torch
from torch import Tensor

from motion.arrays import Floats


@dataclass(frozen=True)
class Diffusion:
    """A schedule for adding noise to motion or its latent.

    Attributes
    ----------
    beta_start, beta_end : float
        Variance of the noise that the first and the last step add.
    steps : int
        Number of steps.
    scaled : bool
        Whether the standard deviation grows linearly, as in latent diffusion (Rombach et al.
        2022), and not the variance.
    """

    beta_start: float = 1e-4
    beta_end: float = 0.02
    steps: int = 1000
    scaled: bool = False

    @cached_property
    def alpha_bar(self) -> Floats:
        """Share of the signal's variance that is left after each step, (steps,)."""
        power = 2 if self.scaled else 1
        ends = self.beta_start ** (1 / power), self.beta_end ** (1 / power)
        beta = np.linspace(*ends, self.steps, dtype=np.float64) ** power
        return np.cumprod(1.0 - beta, dtype=np.float64)

    def x_t(self, x0: Tensor, eps: Tensor, t: Tensor) -> Tensor:
        """Return clean motion `x0` with the noise `eps` of diffusion steps `t`."""
        alpha_bar = self.alpha_bar_at(t, x0)
        return alpha_bar.sqrt() * x0 + (1 - alpha_bar).sqrt() * eps

    def x0_hat(self, x_t: Tensor, eps: Tensor, t: Tensor) -> Tensor:
        """Return the clean motion in `x_t`, given its noise `eps`."""
        alpha_bar = self.alpha_bar_at(t, x_t)
        return (x_t - (1 - alpha_bar).sqrt() * eps) / alpha_bar.sqrt()

    def v(self, x0: Tensor, eps: Tensor, t: Tensor) -> Tensor:
        """Return the velocity at diffusion steps `t` (Salimans & Ho 2022); its variance is 1."""
        alpha_bar = self.alpha_bar_at(t, x0)
        return alpha_bar.sqrt() * eps - (1 - alpha_bar).sqrt() * x0

    def eps_of_v(self, x_t: Tensor, v: Tensor, t: Tensor) -> Tensor:
        """Return the noise in `x_t` whose velocity is `v`."""
        alpha_bar = self.alpha_bar_at(t, x_t)
        return alpha_bar.sqrt() * v + (1 - alpha_bar).sqrt() * x_t

    def alpha_bar_at(self, t: Tensor, motion: Tensor) -> Tensor:
        """Return `alpha_bar` at the steps `t`, in a shape that multiplies `motion`."""
        alpha_bar = torch.as_tensor(self.alpha_bar, dtype=torch.float32, device=motion.device)[t]
        return alpha_bar.reshape(-1, *([1] * (motion.ndim - 1)))

    def ddim(
        self,
        x_t: Tensor,
        eps_of: Callable[[Tensor, Tensor], Tensor],
        steps: int,
        clip: float | None = None,
    ) -> Tensor:
        """Remove the noise of `x_t` in evenly spaced steps.

        Song et al. 2021, equation 12 without new noise (eta = 0). As in latent diffusion, each step
        is one more than a multiple of the spacing, and the last one leads to the schedule's first
        step rather than to no noise.

        Parameters
        ----------
        x_t : Tensor
            Noise of the schedule's last step.
        eps_of : callable
            Maps a noisy value and its step, (1,), to the noise in it.
        steps : int
            From 1 to the schedule's number of steps.
        clip : float, optional
            Largest absolute value of each step's estimate of the clean motion.
        """
        stride = self.steps // steps
        for step in reversed(range(steps)):
            t, t_next = (
                torch.tensor([step_index], device=x_t.device)
                for step_index in (
                    min(step * stride + 1, self.steps - 1),
                    max((step - 1) * stride + 1, 0),
                )
            )
            eps = eps_of(x_t, t)
            x0_hat = self.x0_hat(x_t, eps, t)
            x_t = self.x_t(x0_hat if clip is None else x0_hat.clamp(-clip, clip), eps, t_next)
        return x_t


LINEAR: Final = Diffusion()
"""The schedule of DDPM and of DiffSHEG."""

SCALED_LINEAR: Final = Diffusion(beta_start=0.00085, beta_end=0.012, scaled=True)
"""The schedule of latent diffusion and of AMUSE."""


def step_embedding(t: Tensor, width: int) -> Tensor:
    """Return cosines and sines of diffusion steps, (batch, width).

    Frequencies fall from 1 to 1/10000 (Vaswani et al. 2017, section 3.5).
    """
    half = width // 2
    exponents = torch.arange(half, dtype=torch.float32, device=t.device) / half
    angles = t[:, None].float() * torch.exp(-math.log(10_000) * exponents)
    return torch.cat([angles.cos(), angles.sin()], dim=-1)
