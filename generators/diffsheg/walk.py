"""Which steps FOPPAS takes through the noise. Loads no torch.

Fast outpainting-based partial autoregressive sampling (section 3.5): DDIM in place of DDPM, and
RePaint's resampling for the windows that continue another one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Final

from motion.errors import InputError
from training.noise_schedule import LINEAR_NOISE

CLEAN: Final = -1
"""The place where no noise is left."""


@dataclass(frozen=True, kw_only=True)
class Sampling:
    """How windows are sampled.

    Attributes
    ----------
    steps : int
        Steps of DDIM from pure noise to a clean window.
    overlap : int
        Frames that a window shares with the one before.
    entry : int
        Steps of a window that continues another one.
    jump_length : int
        Steps that resampling goes back into the noise at once.
    jump_count : int
        How often each such stretch is walked: 1 for no resampling, 2 as the release's fast
        setting, 5 as its careful one.
    blend_below : float
        Shared frames blend linearly into the new window while less noise than this is left, as a
        standard deviation; before, they are what the window before says.
    keeps_pose : bool
        Whether a window that continues another one sets out from noise around the last pose it
        knows. The release sets out from pure noise, although a twenty-fifth of the motion's
        variance should be left by then: slow parts of the motion fade from window to window.
    own_noise : bool
        Whether shared frames get the noise that the network has just found in them; RePaint and
        the release give them fresh noise at each step, with which the new frames do not agree.
    """

    steps: int = 25
    overlap: int = 4
    entry: int = 15
    jump_length: int = 3
    jump_count: int = 2
    blend_below: float = 0.2
    keeps_pose: bool = False
    own_noise: bool = False

    def __post_init__(self) -> None:
        least = {"steps": 1, "entry": 1, "jump_length": 1, "jump_count": 1, "overlap": 0}
        for name, minimum in least.items():
            if getattr(self, name) < minimum:
                raise InputError(
                    f"sampling with {name} {getattr(self, name)} is not possible",
                    remedy=f"Give at least {minimum}",
                )
        if LINEAR_NOISE.steps % self.steps:
            raise InputError(
                f"{self.steps} steps do not divide the {LINEAR_NOISE.steps} of the training",
                remedy="Give 10, 20, 25, 40, 50 or 100 steps",
            )
        if self.entry > self.steps:
            raise InputError(
                f"a window cannot be entered {self.entry} steps before the end of {self.steps}",
                remedy="Give an entry of at most the number of steps",
            )

    @cached_property
    def timesteps(self) -> tuple[int, ...]:
        """The diffusion step at each place, from the least noise to the most."""
        return tuple(range(0, LINEAR_NOISE.steps, LINEAR_NOISE.steps // self.steps))

    @cached_property
    def first_walk(self) -> tuple[int, ...]:
        """Places of a window that continues none, down to `CLEAN`."""
        return (*range(self.steps - 1, -1, -1), CLEAN)

    @cached_property
    def later_walk(self) -> tuple[int, ...]:
        """Places of a window that continues another one, down to `CLEAN`.

        Lugmayr et al. 2022 (RePaint), Figure 9: each stretch of `jump_length` steps is walked
        `jump_count` times, noise being added in between.
        """
        left = dict.fromkeys(
            range(0, self.entry - self.jump_length, self.jump_length), self.jump_count - 1
        )
        place, places = self.entry - 1, [self.entry - 1]
        while place >= 0:
            if left.get(place, 0):
                left[place] -= 1
                places += range(place + 1, place + self.jump_length + 1)
                place += self.jump_length
            place -= 1
            places.append(place)
        return tuple(places)


def evaluations(walk: tuple[int, ...]) -> int:
    """Return how often the network is asked on a walk: once for every step down."""
    return sum(there < here for here, there in pairwise(walk))
