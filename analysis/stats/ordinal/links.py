"""Ordered answers: thresholds between them, and link functions with their derivatives.

An answer's interval lies between two ends; eta, the latent value, moves both down by as much as it
grows. Where noise is logistic, the probability is F(upper) F(-lower) (1 - exp(lower - upper)): a
product of three factors of which each depends on one thing, so that its derivatives are short.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import logit, ndtr

Floats = NDArray[np.float64]
Link = Literal["logit", "probit"]
Changes = tuple[Floats, Floats, Floats]

SMALLEST: Final = 1e-300
"""Probabilities below it are taken for it: their logarithm must exist."""

NARROWEST: Final = 1e-100
"""Distances between neighbouring thresholds below it are taken for it: one over it must exist."""

STEEPEST: Final = 690.0
"""Ends beyond it are taken for it: exponentials of it are finite."""

Structure = Literal["flexible", "symmetric", "symmetric around zero"]


class Interval(ABC):
    """Each answer's probability p = F(upper end) - F(lower end), all of shape (N,)."""

    @property
    @abstractmethod
    def log_probability(self) -> Floats:
        """Logarithm of p."""

    @property
    @abstractmethod
    def slope(self) -> Floats:
        """First derivative of log p by eta."""

    @property
    @abstractmethod
    def weights(self) -> Floats:
        """Minus its second derivative; never negative, as the links are log-concave."""

    @property
    @abstractmethod
    def weight_slope(self) -> Floats:
        """Derivative of `weights` by eta."""

    @property
    @abstractmethod
    def by_upper(self) -> Changes:
        """Derivatives of log p, of `slope` and of `weights` by the upper end."""

    @property
    @abstractmethod
    def by_lower(self) -> Changes:
        """The same by the lower end."""


def interval(lower: Floats, upper: Floats, link: Link) -> Interval:
    """Return the probability of lower < latent <= upper with its derivatives.

    Parameters
    ----------
    lower, upper : ndarray, shape (N,)
        Ends; the lowest and the highest may be infinite, `lower` is below `upper`.
    link : {'logit', 'probit'}
        Distribution of the latent scale.
    """
    return LogisticInterval(lower, upper) if link == "logit" else NormalInterval(lower, upper)


class LogisticInterval(Interval):
    """Intervals of the logistic distribution."""

    def __init__(self, lower: Floats, upper: Floats) -> None:
        self._ends = lower, upper
        self._odds_above, self._below = _odds(-upper)
        self._odds_below, self._above = _odds(lower)

    @cached_property
    def _gap(self) -> Floats:
        lower, upper = self._ends
        return np.maximum(-np.expm1(lower - upper), NARROWEST)

    @cached_property
    def _not_below(self) -> Floats:
        # Not 1 - F, which loses its digits in the tails.
        return self._odds_above * self._below

    @cached_property
    def _not_above(self) -> Floats:
        return self._odds_below * self._above

    @cached_property
    def log_probability(self) -> Floats:
        """Logarithm of p."""
        return np.log(np.maximum(self._below * self._above * self._gap, SMALLEST))

    @cached_property
    def slope(self) -> Floats:
        """First derivative of log p by eta."""
        return np.asarray(self._below - self._above)

    @cached_property
    def _upper_density(self) -> Floats:
        return np.asarray(self._below * self._not_below)

    @cached_property
    def _lower_density(self) -> Floats:
        return np.asarray(self._above * self._not_above)

    @cached_property
    def weights(self) -> Floats:
        """Minus its second derivative."""
        return self._upper_density + self._lower_density

    @cached_property
    def _upper_bend(self) -> Floats:
        return self._upper_density * (self._not_below - self._below)

    @cached_property
    def _lower_bend(self) -> Floats:
        return self._lower_density * (self._not_above - self._above)

    @cached_property
    def weight_slope(self) -> Floats:
        """Derivative of `weights` by eta."""
        return self._lower_bend - self._upper_bend

    @property
    def by_upper(self) -> Changes:
        """Derivatives of log p, of `slope` and of `weights` by the upper end."""
        return self._not_below + self._nearness, self._upper_density, self._upper_bend

    @property
    def by_lower(self) -> Changes:
        """The same by the lower end."""
        return -self._not_above - self._nearness, self._lower_density, -self._lower_bend

    @cached_property
    def _nearness(self) -> Floats:
        """Derivative of log(1 - exp(lower - upper)) by the upper end."""
        return np.asarray(1 / self._gap - 1)


def _odds(logit: Floats) -> tuple[Floats, Floats]:
    """Return the odds of log odds `logit`, and one over one plus them."""
    odds = np.minimum(logit, STEEPEST)
    np.exp(odds, out=odds)
    share = odds + 1
    return odds, np.reciprocal(share, out=share)


@dataclass(frozen=True)
class _End:
    """An end's density and its first two derivatives, each over p; signed as in F(u) - F(l)."""

    density: Floats
    first: Floats
    second: Floats


class NormalInterval(Interval):
    """Intervals of the normal distribution."""

    def __init__(self, lower: Floats, upper: Floats) -> None:
        # Far in the upper tail 1 - F loses all digits: there the mirrored interval is taken.
        mirrored = lower + upper > 0
        low, high = np.where(mirrored, -upper, lower), np.where(mirrored, -lower, upper)
        self._probability = np.maximum(ndtr(high) - ndtr(low), SMALLEST)
        self._lower, self._upper = lower, upper

    @cached_property
    def log_probability(self) -> Floats:
        """Logarithm of p."""
        return np.asarray(np.log(self._probability))

    def _end(self, at: Floats, sign: float) -> _End:
        finite = np.isfinite(at)
        place = np.where(finite, at, 0.0)
        density = sign * finite * np.exp(-0.5 * place**2)
        density /= self._probability * np.sqrt(2 * np.pi)
        return _End(density, -place * density, (place**2 - 1) * density)

    @cached_property
    def _ends(self) -> tuple[_End, _End]:
        return self._end(self._upper, 1.0), self._end(self._lower, -1.0)

    @cached_property
    def slope(self) -> Floats:
        """First derivative of log p by eta."""
        upper, lower = self._ends
        return -(upper.density + lower.density)

    @cached_property
    def weights(self) -> Floats:
        """Minus its second derivative."""
        upper, lower = self._ends
        return np.maximum(self.slope**2 - (upper.first + lower.first), 0.0)

    @cached_property
    def weight_slope(self) -> Floats:
        """Derivative of `weights` by eta."""
        upper, lower = self._ends
        first, second = upper.first + lower.first, upper.second + lower.second
        return second + 3 * first * self.slope - 2 * self.slope**3

    @property
    def by_upper(self) -> Changes:
        """Derivatives of log p, of `slope` and of `weights` by the upper end."""
        return self._by(self._ends[0])

    @property
    def by_lower(self) -> Changes:
        """The same by the lower end."""
        return self._by(self._ends[1])

    def _by(self, end: _End) -> Changes:
        upper, lower = self._ends
        first = upper.first + lower.first
        cross = end.first + end.density * self.slope
        weight = -(end.second - end.density * first + 2 * self.slope * cross)
        return end.density, -cross, weight


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
