"""Ordered answers: thresholds between them, and the logit link with its derivatives.

An answer's interval lies between two ends; eta, the latent value, moves both down by as much as it
grows. Where noise is logistic, the probability is F(upper) F(-lower) (1 - exp(lower - upper)): a
product of three factors of which each depends on one thing, so that its derivatives are short.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import logit

Floats = NDArray[np.float64]
Changes = tuple[Floats, Floats, Floats]

SMALLEST: Final = 1e-300
"""Smaller probabilities are raised to it, so that their logarithm exists."""

NARROWEST: Final = 1e-100
"""Smaller gaps between neighbouring thresholds are raised to it, so that their inverse exists."""

STEEPEST: Final = 690.0
"""Larger ends are cut to it, so that their exponential is finite."""


class Interval:
    """Each answer's probability p of lower < latent <= upper, with its derivatives, shape (N,).

    Parameters
    ----------
    lower, upper : ndarray, shape (N,)
        Ends; the lowest and the highest may be infinite, `lower` is below `upper`.
    """

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
        """Minus its second derivative; never negative, as the link is log-concave."""
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
class Thresholds:
    """How a vector of free parameters makes ordered thresholds.

    The thresholds are a location and the gaps above it; gaps enter by their logarithm, so that
    no parameter breaks the order.

    Attributes
    ----------
    categories : int
        Number of answers, at least 2.
    """

    categories: int

    @property
    def count(self) -> int:
        """Number of free parameters, which is that of the thresholds."""
        return self.categories - 1

    def values(self, parameters: Floats) -> Floats:
        """Return the thresholds, shape (categories - 1,)."""
        return np.asarray(parameters[0] + np.append(0.0, np.cumsum(np.exp(parameters[1:]))))

    def jacobian(self, parameters: Floats) -> Floats:
        """Return the derivative of each threshold by each parameter, (categories - 1, count)."""
        by_location_and_gaps = np.append(1.0, np.exp(parameters[1:]))
        return np.asarray(np.tril(np.ones((self.count, self.count))) * by_location_and_gaps)

    def parameters(self, thresholds: Floats) -> Floats:
        """Return the free parameters of `thresholds`, shape (categories - 1,)."""
        return np.concatenate([thresholds[:1], np.log(np.diff(thresholds))])

    def start(self, counts: NDArray[np.int64]) -> Floats:
        """Return parameters that fit the answers' `counts` where nothing else has an effect."""
        total = counts.sum()
        cumulated = (np.cumsum(counts)[:-1] + 0.5) / (total + 1)
        thresholds = logit(cumulated)
        return np.append(thresholds[:1], np.log(np.maximum(np.diff(thresholds), 0.05)))
