"""Thresholds between neighbouring answers on the latent scale."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import logit

Floats = NDArray[np.float64]
Structure = Literal["flexible", "symmetric", "symmetric around zero"]


@dataclass(frozen=True)
class Thresholds:
    """How a vector of free parameters makes ordered thresholds.

    The thresholds are a location and the gaps above it; gaps enter by their logarithm, so that
    no parameter breaks the order. Where the structure is symmetric, gaps equally far from the
    middle are one parameter (as in R's `ordinal`).

    Attributes
    ----------
    categories : int
        Number of answers, at least 2.
    structure : {'flexible', 'symmetric', 'symmetric around zero'}
        'symmetric around zero' also puts the middle at 0: no answer is favoured on either side.
    """

    categories: int
    structure: Structure = "flexible"

    @property
    def gap_of(self) -> NDArray[np.intp]:
        """For each gap between thresholds, the number of its parameter."""
        gaps = np.arange(self.categories - 2)
        return gaps if self.structure == "flexible" else np.minimum(gaps, gaps[::-1])

    @property
    def has_location(self) -> bool:
        """Whether the thresholds may shift as a whole."""
        return self.structure != "symmetric around zero"

    @property
    def count(self) -> int:
        """Number of free parameters."""
        return int(self.gap_of.max(initial=-1)) + 1 + self.has_location

    def values(self, parameters: Floats) -> Floats:
        """Return the thresholds, shape (categories - 1,)."""
        gaps = np.exp(parameters[self.has_location :])[self.gap_of]
        steps = np.concatenate([[0.0], np.cumsum(gaps)])
        return np.asarray(steps + (parameters[0] if self.has_location else -steps[-1] / 2))

    def jacobian(self, parameters: Floats) -> Floats:
        """Return the derivative of each threshold by each parameter, (categories - 1, count)."""
        gaps = np.exp(parameters[self.has_location :])[self.gap_of]
        found = np.zeros((self.categories - 1, self.count))
        for place, (gap, parameter) in enumerate(zip(gaps, self.gap_of, strict=True)):
            found[place + 1 :, parameter + self.has_location] += gap
        if self.has_location:
            found[:, 0] = 1.0
        else:
            found -= found[-1] / 2
        return found

    def parameters(self, thresholds: Floats) -> Floats:
        """Return the free parameters of flexible `thresholds`, shape (categories - 1,)."""
        return np.concatenate([thresholds[:1], np.log(np.diff(thresholds))])

    def start(self, counts: NDArray[np.int64]) -> Floats:
        """Return parameters that fit the answers' `counts` where nothing else has an effect."""
        total = counts.sum()
        cumulated = (np.cumsum(counts)[:-1] + 0.5) / (total + 1)
        thresholds = logit(cumulated)
        gaps = np.maximum(np.diff(thresholds), 0.05)
        tied = [np.log(gaps[self.gap_of == number].mean()) for number in np.unique(self.gap_of)]
        return np.array([*([thresholds[0]] if self.has_location else []), *tied])
