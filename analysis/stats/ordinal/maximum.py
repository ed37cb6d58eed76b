"""Maximising a likelihood by its gradient, and confirming the maximum by its curvature."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product
from typing import Any, Final

import numpy as np
from scipy.optimize import minimize

from analysis.stats.ordinal.laplace import Answers, Likelihood, likelihood
from motion.arrays import Bools, Floats

ITERATIONS: Final = 500
ROUGH: Final = 0.02
"""Approximate distance from the maximum, in standard errors, where the quasi-Newton climb ends."""

FINE: Final = 0.005
"""The same if no Newton steps follow."""

CLIMBS: Final = 4
"""Most climbs: another follows if the curvature shows that one did not reach a maximum."""

FINER: Final = 30.0
"""Factor by which each climb comes nearer to the maximum than the one before."""

LAST_STEPS: Final = 5
"""Most Newton steps after a climb."""

FLAT: Final = 1e-4
"""Largest Newton step, in standard errors, that remains at a maximum."""

STEP: Final = 1e-4
"""Step of the central differences of a gradient, relative to parameters above 1."""

ROUNDING: Final = 1e-10
"""Relative error of a log-likelihood."""

SHORT: Final = 0.05
"""Distance, in standard errors, over which neither curvature nor likelihood changes visibly."""

MANY: Final = 40_000
"""Answers from which on the climb starts where a part of them leads."""

EVERY: Final = 3
"""The part has every third group of each random effect."""

BOUNDARY: Final = 0.01
"""A smaller standard deviation, in units of the noise's scale, counts as zero."""

BESIDE: Final = (0.1, 0.3)
"""Deviations that are tried if one is at its boundary."""

LARGEST: Final = 12.0
"""A larger effect or deviation, in units of the noise's scale, has no finite estimate."""


def maximum(
    answers: Answers, *, curved: bool = True
) -> tuple[Floats, Likelihood, Floats | None, bool]:
    """Return parameters, likelihood and curvature at the end, and whether it is a maximum.

    Parameters
    ----------
    answers : Answers
        The answers.
    curved : bool
        Whether to compute the curvature, which takes longer than the climb; without it, the climb's
        approximation tells whether the maximum was reached.
    """
    start, scale = _start(answers)
    climb = _Climb(answers)
    precision = ROUGH if curved else FINE
    for _ in range(CLIMBS):
        candidate, distance, _ = _climbed(climb, start, scale, precision)
        if curved:
            best, current, curvature, maximal = _stepped(climb, candidate)
        else:
            best, current, curvature = candidate, climb.at(candidate), None
            maximal = current.settled and distance < SHORT
        if (higher := _off_the_boundary(climb, best, current)) is not None:
            start, maximal = higher, False
        # Beyond `LARGEST` there is no finite estimate to climb to.
        elif maximal or (np.abs(best[answers.thresholds.count :]) > LARGEST).any():
            break
        else:
            start, precision = best, precision / FINER
        scale = None
    return best, current, curvature, maximal


def _start(answers: Answers) -> tuple[Floats, Floats | None]:
    """Return where to start, and the inverse curvature there, per answer, if it is known."""
    counts = np.bincount(answers.codes, minlength=answers.thresholds.categories)
    thresholds = answers.thresholds.start(counts)
    effects, deviations = np.zeros(answers.fixed.shape[1]), np.full(answers.terms, 0.5)
    start = np.concatenate([thresholds, effects, deviations])
    if len(answers.codes) >= MANY:
        part = answers.part(np.all([codes % EVERY == 0 for codes in answers.layout.groups], axis=0))
        if len(np.unique(part.codes)) == len(counts):
            near, distance, scale = _climbed(_Climb(part), start, None, FINE)
            if distance < SHORT and free_parameters(part, near).all():
                return near, scale
    return start, None


def _off_the_boundary(climb: _Climb, at: Floats, current: Likelihood) -> Floats | None:
    """Return parameters with a higher likelihood if a deviation wrongly fell to zero.

    The gradient at zero is zero whatever the answers, so a search may stop there although the
    likelihood is higher nearby.
    """
    bound = np.flatnonzero(~free_parameters(climb.answers, at))
    for place, size in product(bound, BESIDE):
        trial = at.copy()
        trial[place] = size
        if climb.at(trial).value > current.value + ROUNDING * abs(current.value):
            return trial
    return None


def _climbed(
    climb: _Climb, start: Floats, scale: Floats | None, precision: float
) -> tuple[Floats, float, Floats]:
    """Climb by a quasi-Newton method.

    Also return its estimated distance left, in errors, and inverse curvature, per answer.
    """
    options: dict[str, Any] = {
        "gtol": precision * _gradient_unit(climb.answers),
        "maxiter": ITERATIONS,
        "hess_inv0": scale,
    }
    end = minimize(climb.descent, start, jac=True, method="BFGS", options=options)  # type: ignore[call-overload]
    left = math.sqrt(len(climb.answers.codes) * abs(float(end.jac @ end.hess_inv @ end.jac)))
    return np.asarray(end.x, np.float64), left, (end.hess_inv + end.hess_inv.T) / 2


def _stepped(climb: _Climb, parameters: Floats) -> tuple[Floats, Likelihood, Floats, bool]:
    """Take Newton steps; the curvature is computed anew only after a long one."""
    for _ in range(LAST_STEPS):
        current, curvature = climb.at(parameters), climb.curvature(parameters)
        free = free_parameters(climb.answers, parameters)
        inside = curvature[np.ix_(free, free)]
        step, length = _step(inside, current.gradient[free])
        if length < FLAT:
            return parameters, current, curvature, current.settled
        if math.isinf(length):
            break
        trial = parameters.copy()
        trial[free] += step
        following = climb.at(trial)
        if following.value < current.value - ROUNDING * abs(current.value):
            break
        parameters, current = trial, following
        _, remaining = _step(inside, current.gradient[free])
        if remaining < FLAT and length < SHORT:
            return parameters, current, curvature, current.settled
    return parameters, current, curvature, False


def _gradient_unit(answers: Answers) -> float:
    """Return the approximate gradient per answer at one standard error from the maximum.

    The precision of an effect that differs between groups depends on their number; other effects
    are more precise.
    """
    count = len(answers.codes)
    return math.sqrt(min(answers.layout.sizes)) / count


def free_parameters(answers: Answers, parameters: Floats) -> Bools:
    """Return which parameters are not at a boundary."""
    _, _, deviations = answers.split(parameters)
    free = np.ones(len(parameters), bool)
    free[-answers.terms :] = np.abs(deviations) >= BOUNDARY
    return free


class _Climb:
    """Likelihoods along the way to the maximum, each begun where the last one ended."""

    def __init__(self, answers: Answers) -> None:
        self.answers = answers
        self.last: Likelihood | None = None

    def at(self, parameters: Floats) -> Likelihood:
        current = likelihood(self.answers, parameters, self.last)
        if not np.isfinite(current.value):
            none = np.zeros_like(parameters)
            return replace(current, value=-np.inf, gradient=none, settled=False)
        self.last = current
        return current

    def descent(self, parameters: Floats) -> tuple[float, Floats]:
        """Return the minimised value per answer, and its gradient."""
        current = self.at(parameters)
        count = len(self.answers.codes)
        return -current.value / count, -current.gradient / count

    def curvature(self, parameters: Floats) -> Floats:
        """Return minus the second derivatives, by central differences of the gradient."""
        columns = []
        for step in STEP * np.diag(np.maximum(1.0, np.abs(parameters))):
            after, before = (self.at(parameters + s).gradient for s in (step, -step))
            columns.append((before - after) / (2 * step.max()))
        matrix = np.column_stack(columns)
        return np.asarray((matrix + matrix.T) / 2, np.float64)


def _step(curvature: Floats, gradient: Floats) -> tuple[Floats, float]:
    """Return Newton's step and its largest length in standard errors; infinite without one."""
    try:
        covariance = np.linalg.inv(curvature)
        np.linalg.cholesky(curvature)
    except np.linalg.LinAlgError:
        return np.zeros_like(gradient), math.inf
    step = covariance @ gradient
    return step, float(np.abs(step / np.sqrt(np.diagonal(covariance))).max(initial=0.0))
