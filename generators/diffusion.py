"""Diffusion: how much noise each step holds, and the way back.

Ho et al. 2020 (DDPM) and Song et al. 2021 (DDIM). Both formulas and the schedule are so short, and
so much depends on which step of a resampled walk is next, that they stand here; tests hold them
against an independent derivation.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor


@dataclass(frozen=True)
class LinearSchedule:
    """Noise that grows linearly from step to step.

    Attributes
    ----------
    first, last : float
        Variance that the first and the last step add.
    steps : int
        Number of steps.
    """

    first: float = 1e-4
    last: float = 0.02
    steps: int = 1000

    @cached_property
    def kept(self) -> NDArray[np.float64]:
        """Share of the signal's variance that is left after each step (the paper's ᾱ), (steps,)."""
        added = np.linspace(self.first, self.last, self.steps, dtype=np.float64)
        return np.cumprod(1.0 - added, dtype=np.float64)

    def clean(self, noisy: Tensor, noise: Tensor, steps: Tensor) -> Tensor:
        """Return the motion of which `noisy` is left after `steps` that added `noise`."""
        kept = self._kept(noisy, steps)
        return (noisy - (1 - kept).sqrt() * noise) / kept.sqrt()

    def noisy(self, clean: Tensor, noise: Tensor, steps: Tensor) -> Tensor:
        """Return what is left of `clean` after `steps` that added `noise`."""
        kept = self._kept(clean, steps)
        return kept.sqrt() * clean + (1 - kept).sqrt() * noise

    def _kept(self, motion: Tensor, steps: Tensor) -> Tensor:
        kept = torch.as_tensor(self.kept, dtype=torch.float32, device=motion.device)[steps]
        return kept.reshape(-1, *([1] * (motion.ndim - 1)))


LINEAR: Final = LinearSchedule()
"""The schedule of DDPM and of DiffSHEG."""
