"""Strengths of conditions from choices: a conditional logit model, and its identification.

Every situation has a few alternatives; alternative a is chosen with a probability proportional to
exp(features of a · parameters). Davidson's Bradley-Terry model and the Plackett-Luce model are of
this kind. Answers are counted first, so the cost depends on their kinds, not on their number.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.special import expit

from analysis.stats.strength_differences import TwoWayErrors, count_kinds, standard_errors
from motion.arrays import Bools, Floats, Indices
from motion.errors import listed

STEPS: Final = 100
FLAT: Final = 1e-10
"""Largest parameter change after which the maximum counts as reached."""


@dataclass(frozen=True, kw_only=True)
class Choices:
    """Choices between alternatives, which are numbered consecutively over all situations.

    Attributes
    ----------
    features : ndarray, shape (alternatives, parameters)
        Features of each alternative.
    sizes : sequence of int
        Number of alternatives of each situation.
    chosen : ndarray of int, shape (N,)
        The chosen alternatives.
    participant, segment : ndarray of int, shape (N,)
        The participant and the segment of each choice, from 0.
    """

    features: Floats
    sizes: Sequence[int]
    chosen: Indices
    participant: Indices
    segment: Indices

    @cached_property
    def votes(self) -> Floats:
        """How often each alternative was chosen, shape (alternatives,)."""
        return np.bincount(self.chosen, minlength=len(self.features)).astype(np.float64)

    @cached_property
    def starts(self) -> Indices:
        """Index of each situation's first alternative."""
        return np.cumsum([0, *self.sizes[:-1]])

    @cached_property
    def situation_of(self) -> Indices:
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
        """Return each situation's mean of the features, weighted by `shares`."""
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
        Covariance clustered by participant (sandwich, CR0); NaN for one participant.
    influences : ndarray, shape (alternatives, parameters)
        First-order contribution of a choice of each alternative to the estimates' error.
    log_likelihood : float
        At the estimates.
    converged : bool
        Whether the maximum was reached.
    """

    estimates: Floats
    by_model: Floats
    clustered: Floats
    influences: Floats
    log_likelihood: float
    converged: bool


def fit_choices(data: Choices, prior: Floats | None = None) -> ChoiceFit:
    """Fit the model by Newton's method; the likelihood has a single maximum.

    Parameters
    ----------
    data : Choices
        The situations or the prior must identify all parameters; otherwise `converged` is False.
    prior : ndarray, shape (comparisons, parameters), optional
        Features of pseudo-comparisons, each with half a win and half a loss, like the
        pseudo-rankings of Turner, van Etten, Firth & Kosmidis (2020), so that estimates are finite
        for conditions that never lost. The log-likelihood excludes them.
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
            trial = _derivatives(data, parameters + size * step, prior)
            if trial[0] >= value - 1e-12 * abs(value) or size < 1e-8:
                break
            size /= 2
        parameters = parameters + size * step
        value, score, hessian = trial
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
    influences = (data.features - data.mean_features(np.exp(logs))[data.situation_of]) @ bread
    clustered = np.full_like(bread, np.nan)
    if np.ptp(data.participant):
        counts = count_kinds(data.chosen, data.participant, len(influences))
        by_participant = np.asarray(counts @ influences, np.float64)
        clustered = by_participant.T @ by_participant
    return ChoiceFit(
        estimates=parameters,
        by_model=bread,
        clustered=clustered,
        influences=influences,
        log_likelihood=float(data.votes @ logs),
        converged=converged,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Links:
    """The links between conditions by comparisons.

    Attributes
    ----------
    tiers : ndarray of int, shape (conditions,)
        Wins in both directions link the conditions of one tier. Of two tiers, one never lost to the
        other, so their difference has no finite maximum-likelihood estimate (Ford 1957).
    unlinked : str
        Why there is no common scale, with the groups that were never compared with one another;
        empty if all are linked.
    unbeaten : str
        Which conditions never lost to which; empty if there is one tier.
    """

    tiers: Indices
    unlinked: str
    unbeaten: str


def links(beats: Floats, names: Sequence[str]) -> Links:
    """Return the links between conditions.

    Parameters
    ----------
    beats : ndarray, shape (conditions, conditions)
        How often the row's condition was preferred to the column's; a tie counts for both.
    names : sequence of str
        The conditions' names.
    """
    groups, group = connected_components(sparse.csr_matrix(beats + beats.T), directed=False)
    count, tiers = connected_components(
        sparse.csr_matrix(beats), directed=True, connection="strong"
    )
    unlinked = ""
    if groups > 1:
        parts = [_named(names, group == number) for number in range(groups)]
        unlinked = (
            f"never compared with one another, not even through others: {' | '.join(parts)}; "
            "strengths have no common scale"
        )
    unbeaten = []
    for number in range(count if count > 1 and not unlinked else 0):
        inside = tiers == number
        if not beats[~inside][:, inside].any():
            unbeaten.append(f"{_named(names, inside)} never lost to any of the others")
    return Links(tiers=np.asarray(tiers, np.intp), unlinked=unlinked, unbeaten="; ".join(unbeaten))


def _named(names: Sequence[str], chosen: Bools) -> str:
    return listed([name for name, yes in zip(names, chosen, strict=True) if yes])


@dataclass(frozen=True, kw_only=True)
class FittedStrengths:
    """Strengths, or worths, on the log scale; they sum to zero.

    Attributes
    ----------
    conditions : tuple of str
        The conditions, in the order of all arrays.
    strengths : ndarray, shape (conditions,)
        Log strengths; NaN if they are not identified.
    errors, errors_by_model : ndarray, shape (conditions,)
        Standard errors: clustered by participant (CR0); of the model.
    two_way : TwoWayErrors or None
        Errors clustered by participant and segment; None without strengths, or for one participant.
    log_likelihood : float
        At the estimates.
    n, participants : int
        Numbers of answers (or rankings) and of participants.
    tiers : ndarray of int, shape (conditions,)
        See `Links`; all in one tier unless `unbeaten` names who never lost, in which case the fit
        is penalised.
    unbeaten : str
        Which conditions never lost to which; empty if each one lost.
    reason : str
        Why there are no strengths, and every number is NaN; empty if there are. `remark` explains
        missing errors.
    """

    conditions: tuple[str, ...]
    strengths: Floats
    errors: Floats
    errors_by_model: Floats
    two_way: TwoWayErrors | None = None
    log_likelihood: float = math.nan
    n: int
    participants: int
    tiers: Indices
    unbeaten: str = ""
    reason: str = ""

    @property
    def remark(self) -> str:
        """Why clustered errors are NaN although there are strengths; empty otherwise."""
        return "one participant" if self.participants < 2 and not self.reason else ""


def centring(count: int) -> Floats:
    """Return the matrix that maps strengths relative to the first to strengths that sum to zero."""
    return np.asarray(np.eye(count)[:, 1:] - 1 / count)


def strength_fields(linked: Links, data: Choices, fit: ChoiceFit) -> dict[str, Any]:
    """Return the fields of `FittedStrengths` that follow from a fit.

    Its first parameters are the log strengths of all conditions but the first.
    """
    free = len(linked.tiers) - 1
    centre = centring(free + 1)
    influences = fit.influences[:, :free] @ centre.T
    return {
        "strengths": centre @ fit.estimates[:free],
        "errors": standard_errors(centre @ fit.clustered[:free, :free] @ centre.T),
        "errors_by_model": standard_errors(centre @ fit.by_model[:free, :free] @ centre.T),
        "two_way": TwoWayErrors.of(
            influences, data.situation_of, data.chosen, data.participant, data.segment
        ),
        "log_likelihood": fit.log_likelihood,
        "tiers": linked.tiers,
        "unbeaten": linked.unbeaten,
    }


def unknown_strengths(count: int) -> dict[str, Any]:
    """Return the fields of `FittedStrengths` for `count` conditions without strengths."""
    errors = ("strengths", "errors", "errors_by_model")
    return dict.fromkeys(errors, np.full(count, math.nan)) | {"tiers": np.zeros(count, np.intp)}
