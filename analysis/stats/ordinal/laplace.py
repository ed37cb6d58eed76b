"""The likelihood of ordered answers with random effects, by Laplace's approximation.

An answer falls into category k where a latent value eta + noise lies between thresholds k - 1 and
k; eta is the sum of the fixed effects and of one random effect for each grouping. The random
effects are integrated out around their mode (Tierney & Kadane 1986; the approximation of R's
`ordinal::clmm`). The gradient is exact: it tracks the mode by the implicit function theorem.

An answer's interval lies between two ends, from both of which eta is subtracted. With logistic
noise, its probability is F(upper) F(-lower) (1 - exp(lower - upper)): a product of three factors,
each with short derivatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from scipy.special import logit

from analysis.stats.ordinal.crossed import Information, Layout
from motion.arrays import Bools, Floats, Indices, Ints

Changes = tuple[Floats, Floats, Floats]

SMALLEST: Final = 1e-300
"""Smaller probabilities are raised to this, so that their logarithm exists."""

NARROWEST: Final = 1e-100
"""Smaller gaps between neighbouring thresholds are raised to this, to have an inverse."""

STEEPEST: Final = 690.0
"""Larger ends are cut to this, so that their exponential is finite."""


class Interval:
    """Each answer's probability p of lower < latent <= upper, with its derivatives, shape (N,).

    Parameters
    ----------
    lower, upper : ndarray, shape (N,)
        Ends of the intervals; they may be infinite, and `lower` is below `upper`.
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
        # Not 1 - F, which loses precision in the tails.
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
        """Minus the second derivative of log p by eta; never negative: the link is log-concave."""
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
        """Derivatives of log p, of `slope` and of `weights` by the lower end."""
        return -self._not_above - self._nearness, self._lower_density, -self._lower_bend

    @cached_property
    def _nearness(self) -> Floats:
        """Derivative of log(1 - exp(lower - upper)) by the upper end."""
        return np.asarray(1 / self._gap - 1)


def _odds(logit: Floats) -> tuple[Floats, Floats]:
    """Return the odds of log odds `logit`, and 1 / (1 + odds)."""
    odds = np.minimum(logit, STEEPEST)
    np.exp(odds, out=odds)
    share = odds + 1
    return odds, np.reciprocal(share, out=share)


@dataclass(frozen=True)
class Thresholds:
    """Ordered thresholds from a vector of free parameters.

    The parameters are a location and the logarithms of the gaps above it, so no parameter breaks
    the order.

    Attributes
    ----------
    categories : int
        Number of answers, at least 2.
    """

    categories: int

    @property
    def count(self) -> int:
        """Number of free parameters, which equals that of the thresholds."""
        return self.categories - 1

    def values(self, parameters: Floats) -> Floats:
        """Return the thresholds, shape (categories - 1,)."""
        return np.asarray(parameters[0] + np.append(0.0, np.cumsum(np.exp(parameters[1:]))))

    def jacobian(self, parameters: Floats) -> Floats:
        """Return the derivative of each threshold by each parameter, (categories - 1, count)."""
        by_location_and_gaps = np.append(1.0, np.exp(parameters[1:]))
        return np.asarray(np.tril(np.ones((self.count, self.count))) * by_location_and_gaps)

    def start(self, counts: Ints) -> Floats:
        """Return parameters that fit the answers' `counts` if nothing else has an effect."""
        total = counts.sum()
        cumulated = (np.cumsum(counts)[:-1] + 0.5) / (total + 1)
        thresholds = logit(cumulated)
        return np.append(thresholds[:1], np.log(np.maximum(np.diff(thresholds), 0.05)))


STEPS: Final = 100
"""Most steps to the mode of the random effects; five are usual."""

TOLERANCE: Final = 1e-8
"""Error of a standardised random effect at which its mode counts as reached: the length of the last
step, times its ratio to the one before."""

SLOW: Final = 0.1
"""After a step longer than this share of the last one, second derivatives are computed anew."""


@dataclass(frozen=True)
class Answers:
    """Ordered answers as numbers.

    Attributes
    ----------
    codes : ndarray of int, shape (N,)
        The answer's category, from 0.
    thresholds : Thresholds
        The number of categories, and the parametrisation of their thresholds.
    fixed : ndarray, shape (N, k)
        Covariates, without an intercept, which the thresholds replace.
    layout : Layout
        Groups of the random effects, the largest grouping first.
    multipliers : tuple of ndarray, shape (N,)
        For each grouping, the multiplier of each answer's random effect.
    """

    codes: Indices
    thresholds: Thresholds
    fixed: Floats
    layout: Layout
    multipliers: tuple[Floats, ...]

    @property
    def terms(self) -> int:
        """Number of groupings."""
        return len(self.multipliers)

    @property
    def count(self) -> int:
        """Number of parameters: of the thresholds, fixed effects and standard deviations."""
        return self.thresholds.count + int(self.fixed.shape[1]) + self.terms

    def split(self, parameters: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the thresholds' parameters, the fixed effects and the standard deviations."""
        first, second = self.thresholds.count, self.thresholds.count + self.fixed.shape[1]
        return parameters[:first], parameters[first:second], parameters[second:]

    def part(self, chosen: Bools) -> Answers:
        """Return the answers `chosen`, without the groups that have none."""
        names = [np.unique(codes[chosen], return_inverse=True) for codes in self.layout.groups]
        return replace(
            self,
            codes=self.codes[chosen],
            fixed=self.fixed[chosen],
            layout=Layout(
                tuple(codes for _, codes in names), tuple(len(each) for each, _ in names)
            ),
            multipliers=tuple(multiplier[chosen] for multiplier in self.multipliers),
        )


@dataclass(frozen=True)
class Likelihood:
    """The approximated log-likelihood of one parameter vector.

    Attributes
    ----------
    value : float
        Log-likelihood.
    gradient : ndarray, shape (parameters,)
        Its derivative.
    modes : ndarray, shape (random effects,)
        Standardised modes of the random effects.
    settled : bool
        Whether the modes were reached.
    information : Information
        Information of the random effects at their modes.
    """

    value: float
    gradient: Floats
    modes: Floats
    settled: bool
    information: Information


def likelihood(answers: Answers, parameters: Floats, start: Likelihood | None = None) -> Likelihood:
    """Return log-likelihood and gradient at `parameters`.

    Parameters
    ----------
    answers : Answers
        The answers.
    parameters : ndarray, shape (answers.count,)
        See `Answers.split`; the sign of a standard deviation is irrelevant.
    start : Likelihood, optional
        The likelihood at nearby parameters, where the search for the modes begins.
    """
    _, _, deviations = answers.split(parameters)
    scaled = [sd * m for sd, m in zip(deviations, answers.multipliers, strict=True)]
    modes, point, settled = _mode(answers, parameters, scaled, start)
    information = Information.of(answers.layout, scaled, point.weights)
    value = point.log_probability.sum() - 0.5 * modes @ modes - 0.5 * information.log_determinant
    gradient = _gradient(answers, parameters, scaled, modes, point, information)
    return Likelihood(float(value), gradient, modes, settled, information)


def _at(answers: Answers, parameters: Floats, random: Floats) -> Interval:
    free, effects, _ = answers.split(parameters)
    thresholds = answers.thresholds.values(free)
    eta = answers.fixed @ effects + random
    lower = np.append(-np.inf, thresholds)[answers.codes] - eta
    upper = np.append(thresholds, np.inf)[answers.codes] - eta
    return Interval(lower, upper)


def _mode(
    answers: Answers, parameters: Floats, scaled: Sequence[Floats], start: Likelihood | None
) -> tuple[Floats, Interval, bool]:
    """Find the mode of the random effects by Newton's method; halve a step that leads down.

    The second derivatives cost more than a step and change little between steps, so they are
    computed anew only if a step shows slow convergence.
    """
    layout = answers.layout

    def height(effects: Floats) -> tuple[float, Interval]:
        point = _at(answers, parameters, _summed(scaled, layout.spread(effects)))
        return float(point.log_probability.sum() - 0.5 * effects @ effects), point

    modes = np.zeros(layout.count) if start is None else start.modes
    information = start and start.information
    value, point = height(modes)
    last = 1.0
    for _ in range(STEPS):
        information = information or Information.of(layout, scaled, point.weights)
        step = information.solve(layout.gather([m * point.slope for m in scaled]) - modes)
        size = 1.0
        while True:
            trial, trial_point = height(modes + size * step)
            if trial >= value - 1e-10 * abs(value) or size < 1e-6:
                break
            size /= 2
        modes, value, point = modes + size * step, trial, trial_point
        length = float(np.abs(step).max(initial=0.0))
        if length * min(1.0, length / last) < TOLERANCE:
            return modes, point, True
        if length > SLOW * last or size < 1:
            information = None
        last = length
    return modes, point, False


def _gradient(
    answers: Answers,
    parameters: Floats,
    scaled: Sequence[Floats],
    modes: Floats,
    point: Interval,
    information: Information,
) -> Floats:
    """Differentiate the log-likelihood, the log-determinant and, through both, the mode."""
    layout = answers.layout
    directions = information.directions(scaled)
    leverage = _summed(scaled, directions)
    pull = layout.spread(
        information.solve(layout.gather([m * leverage * point.weight_slope for m in scaled]))
    )
    pulled = _summed(scaled, pull)
    # The effect of a change in an answer's eta, directly and through the modes.
    by_eta = point.slope - 0.5 * (leverage * point.weight_slope - point.weights * pulled)
    by_deviation = [
        np.sum(multiplier * (u * by_eta - point.weights * direction - 0.5 * v * point.slope))
        for multiplier, u, direction, v in zip(
            answers.multipliers, layout.spread(modes), directions, pull, strict=True
        )
    ]
    return np.concatenate(
        [
            _by_thresholds(answers, parameters, point, leverage, pulled),
            answers.fixed.T @ by_eta,
            by_deviation,
        ]
    )


def _by_thresholds(
    answers: Answers, parameters: Floats, point: Interval, leverage: Floats, pulled: Floats
) -> Floats:
    """Return the derivative by the thresholds' parameters."""
    categories = answers.thresholds.categories
    by_threshold = np.zeros(categories - 1)
    for place, (density, slope, weight) in (
        (slice(-1), point.by_upper),
        (slice(1, None), point.by_lower),
    ):
        change = density - 0.5 * (leverage * weight + pulled * slope)
        by_threshold += np.bincount(answers.codes, weights=change, minlength=categories)[place]
    free, _, _ = answers.split(parameters)
    return by_threshold @ answers.thresholds.jacobian(free)


def _summed(multipliers: Sequence[Floats], effects: Sequence[Floats]) -> Floats:
    total = np.zeros_like(multipliers[0])
    for multiplier, effect in zip(multipliers, effects, strict=True):
        total += multiplier * effect
    return total
