"""The likelihood of ordered answers with random effects, by Laplace's approximation.

An answer falls into category k where a latent value eta + noise lies between thresholds k - 1 and
k; eta is the sum of the fixed effects and of one random effect for each grouping. The random
effects are integrated out around their mode (Tierney & Kadane 1986; the approximation of R's
`ordinal::clmm`). The gradient is exact: it follows the mode by the implicit function theorem.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.ordinal.crossed import Information, Layout
from analysis.ordinal.links import Interval, Link, interval
from analysis.ordinal.thresholds import Thresholds

Floats = NDArray[np.float64]

STEPS: Final = 100
"""Newton steps to the mode of the random effects; five are usual."""

TOLERANCE: Final = 1e-6
"""Largest change of a standardised random effect after which the mode counts as found: Newton's
steps square their error, so that it is far nearer than that."""


@dataclass(frozen=True)
class Answers:
    """Ordered answers as numbers.

    Attributes
    ----------
    codes : ndarray of int, shape (N,)
        The answer's category, from 0.
    thresholds : Thresholds
        How many categories there are, and how their thresholds are made.
    fixed : ndarray, shape (N, k)
        Covariates; without an intercept, for which the thresholds stand.
    layout : Layout or None
        Groups of the random effects, the largest grouping first; None where there are none.
    multipliers : tuple of ndarray, shape (N,)
        For each grouping, what an answer's random effect is multiplied with.
    link : {'logit', 'probit'}
        Distribution of the noise.
    """

    codes: NDArray[np.intp]
    thresholds: Thresholds
    fixed: Floats
    layout: Layout | None
    multipliers: tuple[Floats, ...]
    link: Link = "logit"

    @property
    def terms(self) -> int:
        """Number of groupings."""
        return len(self.multipliers)

    @property
    def count(self) -> int:
        """Number of parameters: thresholds', fixed effects and standard deviations."""
        return self.thresholds.count + int(self.fixed.shape[1]) + self.terms

    def split(self, parameters: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the thresholds' parameters, the fixed effects and the standard deviations."""
        first, second = self.thresholds.count, self.thresholds.count + self.fixed.shape[1]
        return parameters[:first], parameters[first:second], parameters[second:]


@dataclass(frozen=True)
class Point:
    """The answers' likelihood given the random effects, and its derivatives by eta.

    Attributes
    ----------
    ends : Interval
        Each answer's interval on the latent scale.
    """

    ends: Interval

    @cached_property
    def slope(self) -> Floats:
        """First derivative by eta."""
        return -(self.ends.upper + self.ends.lower)

    @cached_property
    def weights(self) -> Floats:
        """Minus the second derivative by eta; never negative, as the links are log-concave."""
        return np.maximum(self.slope**2 - (self.ends.upper1 + self.ends.lower1), 0.0)

    @cached_property
    def weight_slope(self) -> Floats:
        """Derivative of `weights` by eta."""
        first = self.ends.upper1 + self.ends.lower1
        second = self.ends.upper2 + self.ends.lower2
        return second + 3 * first * self.slope - 2 * self.slope**3

    def by_end(self, which: str) -> tuple[Floats, Floats, Floats]:
        """Return the derivatives by the 'upper' or 'lower' end.

        Returns
        -------
        tuple of ndarray, shape (N,)
            Of the log-likelihood, of its slope by eta, and of `weights`.
        """
        ends = self.ends
        density, first, second = (
            (ends.upper, ends.upper1, ends.upper2)
            if which == "upper"
            else (ends.lower, ends.lower1, ends.lower2)
        )
        total, total_first = ends.upper + ends.lower, ends.upper1 + ends.lower1
        cross = first - density * total
        return density, -cross, -(second - density * total_first - 2 * total * cross)


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
        Whether the modes were found.
    """

    value: float
    gradient: Floats
    modes: Floats
    settled: bool


def likelihood(answers: Answers, parameters: Floats, start: Floats | None = None) -> Likelihood:
    """Return log-likelihood and gradient at `parameters`.

    Parameters
    ----------
    answers : Answers
        What was answered.
    parameters : ndarray, shape (answers.count,)
        See `Answers.split`; the sign of a standard deviation has no meaning.
    start : ndarray, optional
        Modes near which to begin.
    """
    if answers.layout is None:
        return _fixed_only(answers, parameters)
    _, _, deviations = answers.split(parameters)
    scaled = [sd * m for sd, m in zip(deviations, answers.multipliers, strict=True)]
    modes = np.zeros(answers.layout.count) if start is None else start
    modes, point, information, settled = _mode(answers, answers.layout, parameters, scaled, modes)
    value = (
        point.ends.log_probability.sum() - 0.5 * modes @ modes - 0.5 * information.log_determinant
    )
    gradient = _gradient(answers, answers.layout, parameters, scaled, modes, point, information)
    return Likelihood(float(value), gradient, modes, settled)


def _at(answers: Answers, parameters: Floats, random: Floats | float) -> Point:
    free, effects, _ = answers.split(parameters)
    bounds = np.concatenate([[-np.inf], answers.thresholds.values(free), [np.inf]])
    eta = answers.fixed @ effects + random
    lower, upper = bounds[answers.codes] - eta, bounds[answers.codes + 1] - eta
    return Point(interval(lower, upper, answers.link))


def _fixed_only(answers: Answers, parameters: Floats) -> Likelihood:
    point = _at(answers, parameters, 0.0)
    none = np.zeros(len(answers.codes))
    gradient = np.concatenate(
        [
            _by_thresholds(answers, parameters, point, none, none),
            answers.fixed.T @ point.slope,
        ]
    )
    return Likelihood(float(point.ends.log_probability.sum()), gradient, np.empty(0), True)


def _mode(
    answers: Answers, layout: Layout, parameters: Floats, scaled: Sequence[Floats], modes: Floats
) -> tuple[Floats, Point, Information, bool]:
    """Climb to the mode of the random effects; halve a step that leads down."""

    def height(effects: Floats) -> tuple[float, Point]:
        point = _at(answers, parameters, _summed(scaled, layout.spread(effects)))
        return float(point.ends.log_probability.sum() - 0.5 * effects @ effects), point

    value, point = height(modes)
    information = Information.of(layout, scaled, point.weights)
    for _ in range(STEPS):
        step = information.solve(layout.gather([m * point.slope for m in scaled]) - modes)
        size = 1.0
        while True:
            tried, there = height(modes + size * step)
            if tried >= value - 1e-10 * abs(value) or size < 1e-6:
                break
            size /= 2
        modes, value, point = modes + size * step, tried, there
        information = Information.of(layout, scaled, point.weights)
        if np.abs(step).max(initial=0.0) < TOLERANCE:
            return modes, point, information, True
    return modes, point, information, False


def _gradient(
    answers: Answers,
    layout: Layout,
    parameters: Floats,
    scaled: Sequence[Floats],
    modes: Floats,
    point: Point,
    information: Information,
) -> Floats:
    """Differentiate the log-likelihood, the log-determinant and, through both, the mode."""
    directions = information.directions(scaled)
    leverage = _summed(scaled, directions)
    pull = layout.spread(
        information.solve(layout.gather([m * leverage * point.weight_slope for m in scaled]))
    )
    pulled = _summed(scaled, pull)
    # What a change of an answer's eta does, directly and through the modes.
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
    answers: Answers, parameters: Floats, point: Point, leverage: Floats, pulled: Floats
) -> Floats:
    """Return the derivative by the thresholds' parameters."""
    categories = answers.thresholds.categories
    by_threshold = np.zeros(categories - 1)
    for which in ("upper", "lower"):
        density, slope, weight = point.by_end(which)
        change = density - 0.5 * (leverage * weight + pulled * slope)
        sums = np.bincount(answers.codes, weights=change, minlength=categories)
        by_threshold += sums[:-1] if which == "upper" else sums[1:]
    free, _, _ = answers.split(parameters)
    return by_threshold @ answers.thresholds.jacobian(free)


def _summed(multipliers: Sequence[Floats], effects: Sequence[Floats]) -> Floats:
    total = np.zeros_like(multipliers[0])
    for multiplier, effect in zip(multipliers, effects, strict=True):
        total += multiplier * effect
    return total
