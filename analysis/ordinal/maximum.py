"""The maximum of a likelihood: climbed to by its gradient, and known to be one by its curvature."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from analysis.curvature import second_derivatives
from analysis.ordinal.laplace import Answers, Likelihood, likelihood

Floats = NDArray[np.float64]

ITERATIONS: Final = 500
ROUGH: Final = 0.01
"""Gradient, over the square root of the answers, at which the quasi-Newton climb ends: about so
many standard errors from the maximum."""

LAST_STEPS: Final = 5
"""Newton steps after it, at most."""

FLAT: Final = 1e-4
"""Largest Newton step, in standard errors, that is left at a maximum."""

ROUNDING: Final = 1e-10
"""Relative error of a log-likelihood."""

SHORT: Final = 0.05
"""Newton step, in standard errors, over which the curvature does not change."""

MANY: Final = 40_000
"""Answers from which on the climb begins where a part of them leads."""

BOUNDARY: Final = 0.01
"""A standard deviation below it, in units of the noise's scale, is taken for zero."""


def maximum(answers: Answers) -> tuple[Floats, Likelihood, Floats, bool]:
    """Return the best parameters, their likelihood, the curvature there and whether it is one."""
    start, scale = _start(answers)
    climb = _Climb(answers)
    options: dict[str, Any] = {
        "gtol": ROUGH / math.sqrt(len(answers.codes)),
        "maxiter": ITERATIONS,
        "hess_inv0": scale,
    }
    found = np.asarray(
        minimize(climb.descent, start, jac=True, method="BFGS", options=options).x,  # type: ignore[call-overload]
        np.float64,
    )
    # Newton's steps from there on; the curvature is computed anew only after a long one.
    for _ in range(LAST_STEPS):
        here, curvature = climb.at(found), climb.curvature(found)
        free = free_parameters(answers, found)
        inside = curvature[np.ix_(free, free)]
        step, length = _step(inside, here.gradient[free])
        if length < FLAT:
            return found, here, curvature, here.settled
        tried = found.copy()
        tried[free] += step
        there = climb.at(tried)
        if there.value < here.value - ROUNDING * abs(here.value):
            break
        found, here = tried, there
        _, rest = _step(inside, here.gradient[free])
        if rest < FLAT and length < SHORT:
            return found, here, curvature, here.settled
    return found, here, curvature, False


def free_parameters(answers: Answers, parameters: Floats) -> NDArray[np.bool_]:
    """Tell which parameters are not at a boundary."""
    _, _, deviations = answers.split(parameters)
    free = np.ones(len(parameters), bool)
    if answers.terms:
        free[-answers.terms :] = np.abs(deviations) >= BOUNDARY
    return free


def _start(answers: Answers) -> tuple[Floats, Floats | None]:
    """Return where to begin, and the scale of the parameters there.

    Very many answers are begun where a random part of them has its maximum.
    """
    count = len(answers.codes)
    if count > MANY:
        part = np.sort(np.random.default_rng(0).choice(count, MANY // 4, replace=False))
        fewer = replace(
            answers,
            codes=answers.codes[part],
            fixed=answers.fixed[part],
            layout=answers.layout and answers.layout.part(part),
            multipliers=tuple(multiplier[part] for multiplier in answers.multipliers),
        )
        found, _, curvature, maximal = maximum(fewer)
        if maximal and free_parameters(answers, found).all():
            scale = np.linalg.inv(curvature) * len(part)
            return found, (scale + scale.T) / 2
    counts = np.bincount(answers.codes, minlength=answers.thresholds.categories)
    own = answers.thresholds.start(counts)
    start = [own, np.zeros(answers.fixed.shape[1]), np.full(answers.terms, 0.5)]
    return np.concatenate(start), None


class _Climb:
    """Likelihoods along the way to the maximum, each begun at the modes of the last."""

    def __init__(self, answers: Answers) -> None:
        self.answers = answers
        self.modes: Floats | None = None

    def at(self, parameters: Floats) -> Likelihood:
        found = likelihood(self.answers, parameters, self.modes)
        if not np.isfinite(found.value):
            return Likelihood(-np.inf, np.zeros_like(parameters), found.modes, False)
        self.modes = found.modes
        return found

    def descent(self, parameters: Floats) -> tuple[float, Floats]:
        """Return what is minimised, per answer, and its gradient."""
        found = self.at(parameters)
        count = len(self.answers.codes)
        return -found.value / count, -found.gradient / count

    def curvature(self, parameters: Floats) -> Floats:
        """Return minus the second derivatives."""
        return -second_derivatives(lambda at: self.at(at).gradient, parameters)


def _step(curvature: Floats, gradient: Floats) -> tuple[Floats, float]:
    """Return Newton's step and its largest length in standard errors; infinite without one."""
    try:
        covariance = np.linalg.inv(curvature)
        np.linalg.cholesky(curvature)
    except np.linalg.LinAlgError:
        return np.zeros_like(gradient), math.inf
    step = covariance @ gradient
    return step, float(np.abs(step / np.sqrt(np.diagonal(covariance))).max(initial=0.0))
