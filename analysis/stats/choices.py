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

ROOM: Final = 8
"""Cells of clusters and kinds, for each row, up to which empty ones are counted too."""

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
    """Who chose what in which situation, one row for each choice or for several alike.

    Attributes
    ----------
    situations : tuple of Situation
        All that occur.
    situation, way, cluster : ndarray of int, shape (N,)
        The situation, the way within it, and who chose; all from 0.
    times : ndarray of int, shape (N,), or None
        How many choices each row stands for; None for one each.
    """

    situations: tuple[Situation, ...]
    situation: Codes
    way: Codes
    cluster: Codes
    times: Codes | None = None

    @property
    def starts(self) -> Codes:
        """Where each situation's ways begin when all are counted through, and the total."""
        sizes = [len(situation.ways) for situation in self.situations]
        return np.concatenate([[0], np.cumsum(sizes)]).astype(np.intp)

    @cached_property
    def kind(self) -> Codes:
        """Each choice's way, counted through all situations."""
        return np.asarray(self.starts[self.situation] + self.way, np.intp)


@dataclass(frozen=True, kw_only=True)
class Tabulated:
    """All situations' alternatives under one another, and how many votes each was given.

    Attributes
    ----------
    features : ndarray, shape (alternatives, parameters)
        Of each alternative of each situation.
    votes : ndarray, shape (alternatives,)
        How many it has.
    starts : ndarray of int, shape (situations,)
        Where each situation's alternatives begin.
    of : ndarray of int, shape (alternatives,)
        Each alternative's situation.
    """

    features: Floats
    votes: Floats
    starts: Codes
    of: Codes

    @classmethod
    def of_choices(cls, data: Choices) -> Tabulated:
        """Count the votes of each alternative."""
        flat = np.asarray(
            np.bincount(data.kind, data.times, minlength=int(data.starts[-1])), np.float64
        )
        sizes = [len(situation.features) for situation in data.situations]
        return cls(
            features=np.concatenate([situation.features for situation in data.situations]),
            votes=np.concatenate(
                [
                    flat[start : start + len(situation.ways)] @ situation.ways
                    for start, situation in zip(data.starts[:-1], data.situations, strict=True)
                ]
            ),
            starts=np.cumsum([0, *sizes[:-1]]).astype(np.intp),
            of=np.repeat(np.arange(len(sizes)), sizes),
        )

    @cached_property
    def totals(self) -> Floats:
        """Votes of each situation."""
        return np.asarray(np.add.reduceat(self.votes, self.starts), np.float64)

    def log_shares(self, parameters: Floats) -> Floats:
        """Return the logarithm of each alternative's probability within its situation."""
        worth = self.features @ parameters
        worth = worth - np.maximum.reduceat(worth, self.starts)[self.of]
        return np.asarray(
            worth - np.log(np.add.reduceat(np.exp(worth), self.starts))[self.of], np.float64
        )

    def means(self, shares: Floats) -> Floats:
        """Return each situation's mean of the features, weighted with `shares`."""
        weighted = shares[:, None] * self.features
        return np.asarray(np.add.reduceat(weighted, self.starts), np.float64)


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
        What each kind is an answer to.
    log_likelihood : float
        At the estimates.
    choices : int
        How many there were.
    converged : bool
        Whether the maximum was found.
    """

    estimates: Floats
    by_model: Floats
    clustered: Floats
    influences: Floats
    situation: Codes
    log_likelihood: float
    choices: int
    converged: bool


def fit_choices(data: Choices, prior: Floats | None = None) -> ChoiceFit:
    """Fit the model by Newton's method; the likelihood has no other maxima.

    Parameters
    ----------
    data : Choices
        The parameters must be identified by the situations, or by the prior: where some are not,
        `converged` is False.
    prior : ndarray, shape (comparisons, parameters), optional
        What makes each of these comparisons likely. Each is taken to be won half a time and lost
        half a time, as the pseudo-rankings of Turner, van Etten, Firth & Kosmidis (2020), so that
        estimates are finite where nobody ever lost. The log-likelihood leaves them out.
    """
    table = Tabulated.of_choices(data)
    prior = np.empty((0, table.features.shape[1])) if prior is None else prior
    parameters = np.zeros(table.features.shape[1])
    value, score, hessian = _derivatives(table, parameters, prior)
    converged = False
    for _ in range(STEPS):
        try:
            step = np.linalg.solve(hessian, score)
        except np.linalg.LinAlgError:
            break
        size = 1.0
        while True:
            tried = _derivatives(table, parameters + size * step, prior)
            if tried[0] >= value - 1e-12 * abs(value) or size < 1e-8:
                break
            size /= 2
        parameters = parameters + size * step
        value, score, hessian = tried
        if np.abs(step).max(initial=0.0) < FLAT:
            converged = True
            break
    return _with_errors(data, table, parameters, hessian, converged)


def _derivatives(
    table: Tabulated, parameters: Floats, prior: Floats
) -> tuple[float, Floats, Floats]:
    """Return log-likelihood and log-prior, their gradient and minus their second derivatives."""
    logs = table.log_shares(parameters)
    shares = np.exp(logs)
    means = table.means(shares)
    expected = shares * table.totals[table.of]
    score = (table.votes - expected) @ table.features
    hessian = (table.features.T * expected) @ table.features - (means.T * table.totals) @ means
    won = expit(prior @ parameters)
    value = float(table.votes @ logs) + float(np.log(won * (1 - won)).sum()) / 2
    return value, score + (0.5 - won) @ prior, hessian + (prior.T * (won * (1 - won))) @ prior


def _with_errors(
    data: Choices,
    table: Tabulated,
    parameters: Floats,
    hessian: Floats,
    converged: bool,
) -> ChoiceFit:
    try:
        bread = np.asarray(np.linalg.inv(hessian), np.float64)
    except np.linalg.LinAlgError:
        bread = np.full_like(hessian, np.nan)
    logs = table.log_shares(parameters)
    means = table.means(np.exp(logs))
    scores = np.concatenate(
        [
            situation.ways @ (situation.features - mean)
            for situation, mean in zip(data.situations, means, strict=True)
        ]
    )
    return ChoiceFit(
        estimates=parameters,
        by_model=bread,
        clustered=clustered_covariance(bread, scores, data),
        influences=scores @ bread,
        situation=np.repeat(np.arange(len(data.situations)), np.diff(data.starts)),
        log_likelihood=float(table.votes @ logs),
        choices=len(data.way) if data.times is None else int(data.times.sum()),
        converged=converged,
    )


def clustered_covariance(bread: Floats, scores: Floats, data: Choices) -> Floats:
    """Return the covariance clustered by who chose (CR0); NaN where there is one cluster.

    Parameters
    ----------
    bread : ndarray, shape (k, k)
        Inverse of minus the log-likelihood's second derivatives.
    scores : ndarray, shape (kinds, k)
        Gradient of the log-likelihood of each kind of answer.
    data : Choices
        Who chose what.
    """
    kind, cluster = data.kind, data.cluster
    if not (cluster != cluster[:1]).any():
        return np.full_like(bread, np.nan)
    weights = np.ones(len(kind)) if data.times is None else data.times.astype(np.float64)
    clusters, kinds = int(cluster.max(initial=-1)) + 1, len(scores)
    if clusters * kinds <= ROOM * len(kind):
        cells = cluster * kinds + kind
        flat = np.bincount(cells, weights=weights, minlength=clusters * kinds)
        by_cluster = np.asarray(flat.reshape(clusters, kinds) @ scores, np.float64)
    else:
        table = sparse.coo_matrix((weights, (cluster, kind)), shape=(clusters, kinds))
        by_cluster = np.asarray(table.tocsr() @ scores, np.float64)
    return np.asarray(bread @ (by_cluster.T @ by_cluster) @ bread)
