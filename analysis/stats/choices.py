"""Choices among alternatives: a conditional logit model with errors clustered by who chose.

In every situation there are a few alternatives; alternative a is chosen with a probability
proportional to exp(features of a · parameters). Davidson's Bradley-Terry model and the
Plackett-Luce model are of this kind. Answers are tabulated first, so that a million of them cost
what their kinds cost.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.special import expit

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
    """Who chose what in which situation, one row for one or several equal choices.

    Attributes
    ----------
    situations : tuple of Situation
        All that occur.
    kind : ndarray of int, shape (N,)
        The way that was chosen, numbered from 0 through the ways of all situations.
    cluster : ndarray of int, shape (N,)
        Who chose, from 0.
    times : ndarray of int, shape (N,)
        How many choices each row stands for.
    """

    situations: tuple[Situation, ...]
    kind: Codes
    cluster: Codes
    times: Codes

    @cached_property
    def features(self) -> Floats:
        """Features of the alternatives of all situations, shape (alternatives, parameters)."""
        return np.concatenate([situation.features for situation in self.situations])

    @cached_property
    def votes(self) -> Floats:
        """Votes that each alternative was given, shape (alternatives,)."""
        ends = np.cumsum([len(situation.ways) for situation in self.situations])
        counts = np.bincount(self.kind, self.times, minlength=ends[-1])
        return np.concatenate(
            [
                count @ situation.ways
                for count, situation in zip(
                    np.split(counts, ends[:-1]), self.situations, strict=True
                )
            ]
        )

    @cached_property
    def sizes(self) -> list[int]:
        """Number of alternatives of each situation."""
        return [len(situation.features) for situation in self.situations]

    @cached_property
    def starts(self) -> Codes:
        """Place of each situation's first alternative."""
        return np.cumsum([0, *self.sizes[:-1]])

    @cached_property
    def situation_of(self) -> Codes:
        """Situation of each alternative, shape (alternatives,)."""
        return np.repeat(np.arange(len(self.sizes)), self.sizes)

    def totals(self, values: Floats) -> Floats:
        """Return the sum of the alternatives' `values` in each situation."""
        return np.asarray(np.add.reduceat(values, self.starts), np.float64)

    def log_shares(self, parameters: Floats) -> Floats:
        """Return the logarithm of each alternative's probability within its situation."""
        worths = self.features @ parameters
        worths = worths - np.maximum.reduceat(worths, self.starts)[self.situation_of]
        return np.asarray(worths - np.log(self.totals(np.exp(worths)))[self.situation_of])

    def mean_features(self, shares: Floats) -> Floats:
        """Return each situation's mean of the features, weighted with `shares`."""
        return self.totals(shares[:, None] * self.features)


@dataclass(frozen=True, kw_only=True)
class ChoiceFit:
    """Fitted parameters of a choice model.

    Attributes
    ----------
    estimates : ndarray, shape (parameters,)
        Maximum-likelihood estimates.
    by_model : ndarray, shape (parameters, parameters)
        Covariance if the model were true and all choices independent (inverse Hessian).
    clustered : ndarray
        Covariance that lets the choices of one cluster depend on one another (sandwich, CR0).
    influences : ndarray, shape (kinds, parameters)
        What a choice of each kind (`Choices.kind`) adds to the estimates' error, to first order.
    situation : ndarray of int, shape (kinds,)
        Situation of each kind.
    log_likelihood : float
        At the estimates.
    converged : bool
        Whether the maximum was found.
    """

    estimates: Floats
    by_model: Floats
    clustered: Floats
    influences: Floats
    situation: Codes
    log_likelihood: float
    converged: bool


def fit_choices(data: Choices, prior: Floats | None = None) -> ChoiceFit:
    """Fit the model by Newton's method; the likelihood has no other maxima.

    Parameters
    ----------
    data : Choices
        The parameters must be identified by the situations, or by the prior: where some are not,
        `converged` is False.
    prior : ndarray, shape (comparisons, parameters), optional
        Features of pseudo-comparisons, each won half a time and lost half a time, as the
        pseudo-rankings of Turner, van Etten, Firth & Kosmidis (2020), so that estimates are finite
        where nobody ever lost. The log-likelihood leaves them out.
    """
    prior = np.empty((0, data.features.shape[1])) if prior is None else prior
    parameters = np.zeros(data.features.shape[1])
    value, score, hessian = _derivatives(data, parameters, prior)
    converged = False
    for _ in range(STEPS):
        try:
            step = np.linalg.solve(hessian, score)
        except np.linalg.LinAlgError:
            break
        size = 1.0
        while True:
            tried = _derivatives(data, parameters + size * step, prior)
            if tried[0] >= value - 1e-12 * abs(value) or size < 1e-8:
                break
            size /= 2
        parameters = parameters + size * step
        value, score, hessian = tried
        if np.abs(step).max(initial=0.0) < FLAT:
            converged = True
            break
    return _with_errors(data, parameters, hessian, converged)


def _derivatives(data: Choices, parameters: Floats, prior: Floats) -> tuple[float, Floats, Floats]:
    """Return log-likelihood and log-prior, their gradient and minus their second derivatives."""
    logs = data.log_shares(parameters)
    shares = np.exp(logs)
    means, totals = data.mean_features(shares), data.totals(data.votes)
    expected = shares * totals[data.situation_of]
    score = (data.votes - expected) @ data.features
    hessian = (data.features.T * expected) @ data.features - (means.T * totals) @ means
    won = expit(prior @ parameters)
    value = float(data.votes @ logs) + float(np.log(won * (1 - won)).sum()) / 2
    return value, score + (0.5 - won) @ prior, hessian + (prior.T * (won * (1 - won))) @ prior


def _with_errors(data: Choices, parameters: Floats, hessian: Floats, converged: bool) -> ChoiceFit:
    try:
        bread = np.asarray(np.linalg.inv(hessian), np.float64)
    except np.linalg.LinAlgError:
        bread = np.full_like(hessian, np.nan)
    logs = data.log_shares(parameters)
    means = data.mean_features(np.exp(logs))
    scores = np.concatenate(
        [
            situation.ways @ (situation.features - mean)
            for situation, mean in zip(data.situations, means, strict=True)
        ]
    )
    return ChoiceFit(
        estimates=parameters,
        by_model=bread,
        clustered=_clustered_covariance(bread, scores, data),
        influences=scores @ bread,
        situation=np.repeat(
            np.arange(len(data.situations)), [len(each.ways) for each in data.situations]
        ),
        log_likelihood=float(data.votes @ logs),
        converged=converged,
    )


def _clustered_covariance(bread: Floats, scores: Floats, data: Choices) -> Floats:
    """Return the covariance clustered by who chose (CR0); NaN where there is one cluster."""
    if not np.ptp(data.cluster):
        return np.full_like(bread, np.nan)
    shape = (int(data.cluster.max()) + 1, len(scores))
    counts = sparse.coo_array((data.times, (data.cluster, data.kind)), shape=shape)
    by_cluster = np.asarray(counts.tocsr() @ scores, np.float64)
    return np.asarray(bread @ (by_cluster.T @ by_cluster) @ bread)
