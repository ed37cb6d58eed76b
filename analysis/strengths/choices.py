"""Choices among alternatives: a conditional logit model with errors clustered by who chose.

In every situation there are a few alternatives; alternative a is chosen with a probability
proportional to exp(features of a · parameters). Davidson's Bradley-Terry model and the
Plackett-Luce model are of this kind. Answers are tabulated first, so that a million of them cost
what their kinds cost.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_softmax

from analysis.strengths.sandwich import sandwiches

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]

STEPS: Final = 100
FLAT: Final = 1e-10
"""Largest parameter change after which the maximum counts as found."""


@dataclass(frozen=True, kw_only=True)
class Situation:
    """A set of alternatives, and the ways in which somebody can choose among them.

    Attributes
    ----------
    features : ndarray, shape (alternatives, parameters)
        What makes each alternative likely.
    ways : ndarray, shape (ways, alternatives)
        Each way shares one vote out over the alternatives: a plain choice gives it to one.
    """

    features: Floats
    ways: Floats


@dataclass(frozen=True, kw_only=True)
class Choices:
    """Who chose what in which situation, one row for each choice.

    Attributes
    ----------
    situations : tuple of Situation
        All that occur.
    situation, way, cluster : ndarray of int, shape (N,)
        The situation, the way within it, and who chose; all from 0.
    """

    situations: tuple[Situation, ...]
    situation: Codes
    way: Codes
    cluster: Codes

    @property
    def starts(self) -> Codes:
        """Where each situation's ways begin when all are counted through, and the total."""
        sizes = [len(situation.ways) for situation in self.situations]
        return np.concatenate([[0], np.cumsum(sizes)]).astype(np.intp)

    @property
    def kind(self) -> Codes:
        """Each choice's way, counted through all situations."""
        return np.asarray(self.starts[self.situation] + self.way, np.intp)


@dataclass(frozen=True, kw_only=True)
class ChoiceFit:
    """Fitted parameters of a choice model.

    Attributes
    ----------
    estimates : ndarray, shape (parameters,)
        Maximum-likelihood estimates.
    by_model : ndarray, shape (parameters, parameters)
        Covariance if the model were true and all choices independent (inverse Hessian).
    robust : ndarray
        Covariance that doubts the model but not the independence (sandwich, HC0).
    clustered : ndarray
        Covariance that lets the choices of one cluster depend on one another (sandwich, CR0).
    log_likelihood : float
        At the estimates.
    choices, clusters : int
        How many there were.
    converged : bool
        Whether the maximum was found.
    """

    estimates: Floats
    by_model: Floats
    robust: Floats
    clustered: Floats
    log_likelihood: float
    choices: int
    clusters: int
    converged: bool


def fit_choices(data: Choices) -> ChoiceFit:
    """Fit the model by Newton's method; the likelihood has no other maxima.

    Parameters
    ----------
    data : Choices
        The parameters must be identified by the situations: where some are not (a condition that
        never lost), `converged` is False.
    """
    counts = _counts(data)
    parameters = np.zeros(data.situations[0].features.shape[1])
    value, score, hessian = _derivatives(data.situations, counts, parameters)
    converged = False
    for _ in range(STEPS):
        try:
            step = np.linalg.solve(hessian, score)
        except np.linalg.LinAlgError:
            break
        size = 1.0
        while True:
            tried = _derivatives(data.situations, counts, parameters + size * step)
            if tried[0] >= value - 1e-12 * abs(value) or size < 1e-8:
                break
            size /= 2
        parameters = parameters + size * step
        value, score, hessian = tried
        if np.abs(step).max(initial=0.0) < FLAT:
            converged = True
            break
    return _with_errors(data, parameters, value, hessian, converged)


def _counts(data: Choices) -> list[Floats]:
    """Return, for each situation, how often each way was chosen."""
    flat = np.bincount(data.kind, minlength=int(data.starts[-1]))
    return [np.asarray(part, np.float64) for part in np.split(flat, data.starts[1:-1])]


def _derivatives(
    situations: Sequence[Situation], counts: Sequence[Floats], parameters: Floats
) -> tuple[float, Floats, Floats]:
    """Return log-likelihood, its gradient and minus its second derivatives."""
    value, score = 0.0, np.zeros_like(parameters)
    hessian = np.zeros((len(parameters), len(parameters)))
    for situation, count in zip(situations, counts, strict=True):
        votes = count @ situation.ways
        total = votes.sum()
        logs = log_softmax(situation.features @ parameters)
        shares = np.exp(logs)
        mean = shares @ situation.features
        value += float(votes @ logs)
        score += votes @ situation.features - total * mean
        weighted = situation.features.T * shares
        hessian += total * (weighted @ situation.features - np.outer(mean, mean))
    return value, score, hessian


def _with_errors(
    data: Choices,
    parameters: Floats,
    value: float,
    hessian: Floats,
    converged: bool,
) -> ChoiceFit:
    try:
        bread = np.asarray(np.linalg.inv(hessian), np.float64)
    except np.linalg.LinAlgError:
        bread = np.full_like(hessian, np.nan)
    scores = []
    for situation in data.situations:
        shares = np.exp(log_softmax(situation.features @ parameters))
        scores.append(situation.ways @ (situation.features - shares @ situation.features))
    robust, clustered = sandwiches(bread, np.concatenate(scores), data.kind, data.cluster)
    return ChoiceFit(
        estimates=parameters,
        by_model=bread,
        robust=robust,
        clustered=clustered,
        log_likelihood=value,
        choices=len(data.way),
        clusters=int(data.cluster.max(initial=-1)) + 1,
        converged=converged,
    )
