"""Contrasts between conditions, from a fitted cumulative link mixed model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.holm import holm
from analysis.ordinal.mixed_model import OrdinalFit

Floats = NDArray[np.float64]

NORMAL_95: Final = float(stats.norm.ppf(0.975))


@dataclass(frozen=True, kw_only=True)
class Contrast:
    """How much better condition a is rated than condition b.

    Attributes
    ----------
    a, b : str
        The conditions; b is empty for the average of all.
    estimate, standard_error : float
        Difference on the latent scale; NaN where the model gives none.
    low, high : float
        Ends of its 95 % interval, of this contrast alone.
    statistic, p_value : float
        z, and its two-sided p.
    holm_p : float
        p after Holm's correction over all contrasts returned with it.
    odds_ratio, odds_low, odds_high : float
        Odds of a better answer for a over those for b; NaN unless the link is the logit.
    answers : int
        How many the model rests on.
    remark : str
        Why there is no number, or what limits it; empty where nothing does.
    """

    a: str
    b: str
    estimate: float
    standard_error: float
    low: float
    high: float
    statistic: float
    p_value: float
    holm_p: float
    odds_ratio: float
    odds_low: float
    odds_high: float
    answers: int
    remark: str = ""


def contrasts(fit: OrdinalFit, conditions: Sequence[str]) -> tuple[Contrast, ...]:
    """Compare all conditions with each other (Searle, Speed & Milliken 1980; R's `emmeans`).

    Parameters
    ----------
    fit : OrdinalFit
        With one covariate for each condition, 1 for its answers and 0 for all others, except for
        one condition, the model's reference.
    conditions : sequence of str
        All of them; a stands before b in this order.

    Returns
    -------
    tuple of Contrast
        One for each pair, Holm's correction over all of them.
    """
    effects, covariance = _effects(fit, conditions)
    pairs = list(combinations(range(len(conditions)), 2))
    weights = np.zeros((len(pairs), len(conditions)))
    for row, (a, b) in enumerate(pairs):
        weights[row, a], weights[row, b] = 1.0, -1.0
    names = [(conditions[a], conditions[b]) for a, b in pairs]
    return _contrasts(fit, names, weights, effects, covariance)


def effects_around_the_average(fit: OrdinalFit, conditions: Sequence[str]) -> tuple[Contrast, ...]:
    """Compare each condition with the average of all; the estimates add up to zero.

    Parameters
    ----------
    fit, conditions
        As for `contrasts`.
    """
    effects, covariance = _effects(fit, conditions)
    count = len(conditions)
    weights = np.eye(count) - 1 / count
    return _contrasts(fit, [(name, "") for name in conditions], weights, effects, covariance)


def tukey_p(contrast: Contrast, conditions: int) -> float:
    """Return p of one contrast among all pairs of `conditions` (Tukey 1953), as `emmeans` adjusts.

    It is taken from the Studentised range; slower to compute than Holm's correction.
    """
    if math.isnan(contrast.statistic):
        return math.nan
    reached = math.sqrt(2) * abs(contrast.statistic)
    return float(stats.studentized_range.sf(reached, conditions, np.inf))


def _effects(fit: OrdinalFit, conditions: Sequence[str]) -> tuple[Floats, Floats]:
    """Return all conditions' effects and their covariance; those of the reference are zero."""
    absent = [name for name in conditions if name not in fit.estimates]
    if len(absent) != 1 or len(fit.estimates) != len(conditions) - 1:
        raise ValueError("the model needs a covariate for each condition but one")
    effects = np.array([fit.estimates.get(name, 0.0) for name in conditions])
    own = [place for place, name in enumerate(conditions) if name in fit.estimates]
    named = [conditions[place] for place in own]
    covariance = np.zeros((len(conditions), len(conditions)))
    covariance[np.ix_(own, own)] = fit.covariance.loc[named, named].to_numpy(np.float64)
    return effects, covariance


def _contrasts(
    fit: OrdinalFit,
    names: Sequence[tuple[str, str]],
    weights: Floats,
    effects: Floats,
    covariance: Floats,
) -> tuple[Contrast, ...]:
    estimates = weights @ effects
    errors = np.sqrt(np.einsum("ij,jk,ik->i", weights, covariance, weights))
    if not fit.converged:
        # A remark stands beside them; the numbers would be taken for results.
        estimates, errors = np.full_like(estimates, math.nan), np.full_like(errors, math.nan)
    with np.errstate(invalid="ignore", divide="ignore"):
        statistics = estimates / errors
    found = []
    for (a, b), estimate, error, statistic in zip(
        names, estimates.tolist(), errors.tolist(), statistics.tolist(), strict=True
    ):
        low, high = estimate - NORMAL_95 * error, estimate + NORMAL_95 * error
        odds = [math.nan] * 3
        if fit.link == "logit":
            odds = [math.exp(value) for value in (estimate, low, high)]
        found.append(
            Contrast(
                a=a,
                b=b,
                estimate=estimate,
                standard_error=error,
                low=low,
                high=high,
                statistic=statistic,
                p_value=float(2 * stats.norm.sf(abs(statistic))),
                holm_p=math.nan,
                odds_ratio=odds[0],
                odds_low=odds[1],
                odds_high=odds[2],
                answers=fit.answers,
                remark=fit.remark,
            )
        )
    corrected = holm([contrast.p_value for contrast in found])
    return tuple(replace(c, holm_p=p) for c, p in zip(found, corrected, strict=True))
