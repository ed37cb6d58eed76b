"""The likelihood of ordered answers with random effects, by Laplace's approximation.

An answer falls into category k where a latent value eta + noise lies between thresholds k - 1 and
k; eta is the sum of the fixed effects and of one random effect for each grouping. The random
effects are integrated out around their mode (Tierney & Kadane 1986; the approximation of R's
`ordinal::clmm`). The gradient is exact: it follows the mode by the implicit function theorem.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.stats.ordinal.crossed import Information, Layout
from analysis.stats.ordinal.links import Interval, Thresholds

Floats = NDArray[np.float64]

STEPS: Final = 100
"""Steps to the mode of the random effects; five are usual."""

TOLERANCE: Final = 1e-8
"""Error of a standardised random effect with which its mode counts as found: the length of the
last step, times how much shorter it was than the one before."""

SLOW: Final = 0.1
"""A step longer than this share of the last one calls for the second derivatives where it led."""


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
    """

    codes: NDArray[np.intp]
    thresholds: Thresholds
    fixed: Floats
    layout: Layout | None
    multipliers: tuple[Floats, ...]

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
    information : Information or None
        Of the random effects at their modes; None where there are none.
    """

    value: float
    gradient: Floats
    modes: Floats
    settled: bool
    information: Information | None = None


def likelihood(answers: Answers, parameters: Floats, start: Likelihood | None = None) -> Likelihood:
    """Return log-likelihood and gradient at `parameters`.

    Parameters
    ----------
    answers : Answers
        What was answered.
    parameters : ndarray, shape (answers.count,)
        See `Answers.split`; the sign of a standard deviation has no meaning.
    start : Likelihood, optional
        Of parameters nearby: where the way to the modes begins, and what leads it at first.
    """
    if answers.layout is None:
        return _fixed_only(answers, parameters)
    _, _, deviations = answers.split(parameters)
    scaled = [sd * m for sd, m in zip(deviations, answers.multipliers, strict=True)]
    modes, point, settled = _mode(answers, answers.layout, parameters, scaled, start)
    information = Information.of(answers.layout, scaled, point.weights)
    value = point.log_probability.sum() - 0.5 * modes @ modes - 0.5 * information.log_determinant
    gradient = _gradient(answers, answers.layout, parameters, scaled, modes, point, information)
    return Likelihood(float(value), gradient, modes, settled, information)


def _at(answers: Answers, parameters: Floats, random: Floats | float) -> Interval:
    free, effects, _ = answers.split(parameters)
    thresholds = answers.thresholds.values(free)
    eta = answers.fixed @ effects + random
    lower = np.append(-np.inf, thresholds)[answers.codes] - eta
    upper = np.append(thresholds, np.inf)[answers.codes] - eta
    return Interval(lower, upper)


def _fixed_only(answers: Answers, parameters: Floats) -> Likelihood:
    point = _at(answers, parameters, 0.0)
    none = np.zeros(len(answers.codes))
    gradient = np.concatenate(
        [
            _by_thresholds(answers, parameters, point, none, none),
            answers.fixed.T @ point.slope,
        ]
    )
    return Likelihood(float(point.log_probability.sum()), gradient, np.empty(0), True)


def _mode(
    answers: Answers,
    layout: Layout,
    parameters: Floats,
    scaled: Sequence[Floats],
    start: Likelihood | None,
) -> tuple[Floats, Interval, bool]:
    """Climb to the mode of the random effects by Newton's method; halve a step that leads down.

    The second derivatives cost more than a step, and change little from one to the next: they
    are computed anew only where a step shows that they do not lead straight to the mode.
    """

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
    layout: Layout,
    parameters: Floats,
    scaled: Sequence[Floats],
    modes: Floats,
    point: Interval,
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
