"""How much noise each step of a diffusion holds: numbers alone, without any network."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class NoiseSchedule:
    """Noise that grows from step to step (Ho et al. 2020, DDPM).

    Attributes
    ----------
    first, last : float
        Variance that the first and the last step add.
    steps : int
        Number of steps.
    scaled : bool
        Whether the standard deviation grows linearly, as in latent diffusion (Rombach et al.
        2022), and not the variance.
    """

    first: float = 1e-4
    last: float = 0.02
    steps: int = 1000
    scaled: bool = False

    @cached_property
    def alpha_bar(self) -> NDArray[np.float64]:
        """Share of the signal's variance that is left after each step, (steps,)."""
        power = 2 if self.scaled else 1
        ends = self.first ** (1 / power), self.last ** (1 / power)
        added = np.linspace(*ends, self.steps, dtype=np.float64) ** power
        return np.cumprod(1.0 - added, dtype=np.float64)


LINEAR_NOISE: Final = NoiseSchedule()
"""The schedule of DDPM and of DiffSHEG."""
