"""How a simulated rater takes part, apart from what it answers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

from studyapp.rehearsal.simulation.chance import stream
from studyapp.rehearsal.simulation.raters import Rater

THINKS: Final = 4.0
"""Median seconds between the end of the last video and the answers."""

THINKS_SPREAD: Final = 0.4
"""Standard deviation of the logarithm of those seconds, over raters and trials."""

HASTY_THINKS: Final = 0.3
"""Median seconds of who is hasty."""

HASTY_SPARE: Final = 0.01
"""Share of each video that who is hasty watches beyond what must be watched."""


@dataclass(frozen=True, kw_only=True)
class Conduct:
    """How one rater takes part.

    Attributes
    ----------
    rater : Rater
        Who.
    trials : int
        Trials of its study session, at least 1.
    coverage : float
        Share of each video that must be watched, in [0, 1].
    """

    rater: Rater
    trials: int
    coverage: float

    @cached_property
    def leaves_at(self) -> int | None:
        """Position, from 1, of the trial at whose page it leaves; None where it stays."""
        if self.rater.kind not in ("dropping_out", "returning"):
            return None
        chance = stream(self.rater.seed, "leaves", self.rater.name)
        return int(chance.integers(1, self.trials + 1))

    @property
    def returns(self) -> bool:
        """Whether it comes back after it has left."""
        return self.rater.kind == "returning"

    @property
    def clicks_twice(self) -> bool:
        """Whether it presses every button twice."""
        return self.rater.kind == "double_clicking"

    @property
    def watches(self) -> float:
        """Share of each video that it watches, in [0, 1]."""
        return min(1.0, self.coverage + HASTY_SPARE) if self._is_hasty else 1.0

    def thinks(self, position: int) -> float:
        """Return the seconds it takes for its answers to the trial at `position`."""
        draw = stream(self.rater.seed, "thinks", self.rater.name, position)
        median = HASTY_THINKS if self._is_hasty else THINKS
        return median * float(draw.lognormal(0.0, THINKS_SPREAD))

    @property
    def _is_hasty(self) -> bool:
        return self.rater.kind == "hasty"
