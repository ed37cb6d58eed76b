"""The rank correlation of a metric with people's preference over conditions, with an interval."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Literal

import numpy as np

from analysis.results.resamples import OrientedMetric, ResampledPreferences
from analysis.stats.clustered_mean import Interval
from analysis.stats.samples import bootstrap_counts, percentile_interval
from motion.arrays import Floats

FEWEST: Final = 3
"""Fewest conditions: two always agree entirely or not at all."""

FEWEST_FOR_INTERVAL: Final = 4

_ROUNDING: Final = 1e-9
"""Scores that differ by less, relative to the largest, are equal."""

_LEAST_USABLE: Final = 0.5
"""Smallest share of resamples that must have a correlation."""

METHOD: Final = (
    "95% interval: the widest ends of three ranges: the percentiles of resamples that redraw "
    "conditions, participants and segments together; these percentiles reflected about the "
    "estimate; and the true correlations that are compatible with the estimate at this number "
    "of conditions"
)

Kind = Literal["kendall", "spearman"]

_SEED: Final = 20

_STUDIES: Final = 20_000

_STUDIES_ON_GRID: Final = 4_000

_GRID: Final = np.tanh(np.linspace(0, 3.8, 39))
"""Correlations of normal scores, from 0 to nearly 1."""

_BLOCK: Final = 2_000_000
"""Comparisons simulated at a time, which bounds the memory."""


@dataclass(frozen=True, kw_only=True)
class RankCorrelation(Interval):
    """A rank correlation over conditions, above zero if the metric and people agree.

    Attributes
    ----------
    degenerate : int
        Resamples without a correlation, which the interval leaves out.
    """

    degenerate: int = 0


@dataclass(frozen=True, kw_only=True)
class SamplingRange:
    """The correlations that studies without other errors find if the true one is `tau`.

    Attributes
    ----------
    tau : float
        Kendall's tau among all conditions like these.
    low, high : float
        Ends between which 95% of studies with `conditions` conditions find it.
    conditions : int
        Number of conditions of a study.
    """

    tau: float
    low: float
    high: float
    conditions: int


def order_signs(values: Floats) -> Floats:
    """Return which of every two values is the larger.

    Parameters
    ----------
    values : ndarray, shape (B, k)
        Finite.

    Returns
    -------
    ndarray, shape (B, k, k)
        1 if the row's value is larger than the column's, -1 if it is smaller, 0 if they are equal
        but for rounding.
    """
    gaps = values[:, :, None] - values[:, None, :]
    largest = np.abs(values).max(axis=1, initial=0)[:, None, None]
    return np.asarray(np.sign(gaps) * (np.abs(gaps) > _ROUNDING * largest), np.float64)


def kendall(first: Floats, second: Floats, weights: Floats) -> Floats:
    """Return Kendall's tau-b (Kendall 1945).

    Parameters
    ----------
    first, second : ndarray, shape (B, k, k)
        Signs of the order of k items, from `order_signs`.
    weights : ndarray, shape (B, k)
        How often each item was drawn; an item drawn twice is tied with itself.

    Returns
    -------
    ndarray, shape (B,)
        NaN if all drawn items are tied in either.
    """
    products, first_squares, second_squares = (
        np.einsum("bi,bij,bij,bj->b", weights, x, y, weights, optimize=True)
        for x, y in ((first, second), (first, first), (second, second))
    )
    return _scaled(products, first_squares, second_squares)


def spearman(first: Floats, second: Floats, weights: Floats) -> Floats:
    """Return Spearman's rho, with mean ranks for ties; see `kendall`."""
    total = weights.sum(axis=1, keepdims=True)

    def centred_ranks(signs: Floats) -> Floats:
        ranks = np.einsum("bij,bj->bi", signs, weights)
        return np.asarray(ranks - (weights * ranks).sum(axis=1, keepdims=True) / total)

    x, y = centred_ranks(first), centred_ranks(second)
    products, first_squares, second_squares = (
        (weights * product).sum(axis=1) for product in (x * y, x * x, y * y)
    )
    return _scaled(products, first_squares, second_squares)


def _scaled(product: Floats, first: Floats, second: Floats) -> Floats:
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = product / np.sqrt(first * second)
    correlation[(first < _ROUNDING) | (second < _ROUNDING)] = np.nan
    return np.asarray(np.clip(correlation, -1, 1))


_CORRELATIONS: Final[Mapping[Kind, Callable[[Floats, Floats, Floats], Floats]]] = {
    "kendall": kendall,
    "spearman": spearman,
}


def over_conditions(
    preferences: ResampledPreferences, metric: OrientedMetric, *, too_few: str, seed: int
) -> tuple[RankCorrelation, RankCorrelation]:
    """Return Kendall's tau-b and Spearman's rho.

    Resampling alone gives too narrow an interval: if four conditions agree entirely, so does every
    resample, and noise in scores and answers moves resamples towards zero a second time. So the
    interval is never narrower than the resamples reflected about the estimate, nor than the number
    of conditions allows (`compatible`).

    Parameters
    ----------
    preferences : ResampledPreferences
        People's preferences.
    metric : OrientedMetric
        The metric, of the same conditions and segments.
    too_few : str
        Why there are no resamples of participants or segments; empty if there are.
    seed : int
        The same seed gives the same resamples.
    """
    present = metric.present
    whole_study = np.ones((1, preferences.segments.shape[1]))
    scores, liking = metric.resampled(whole_study), preferences.estimates[None, present]
    if len(present) < FEWEST:
        return _neither(
            f"{len(present)} conditions have scores and answers; a correlation needs {FEWEST}"
        )
    if np.isnan(liking).any():
        return _neither("the conditions fall into groups that were never compared with each other")
    resampled = metric.resampled(preferences.segments), preferences.draws[:, present]
    usable = np.asarray(~np.isnan(np.concatenate(resampled, axis=1)).any(axis=1))
    resamples = len(preferences.draws)
    weights = bootstrap_counts(np.random.default_rng(seed), resamples, len(present))[usable]
    once = np.ones((1, len(present)))
    signs = order_signs(scores), order_signs(liking)
    resampled_signs = [order_signs(values[usable]) for values in resampled]
    correlations = {}
    for kind, correlate in _CORRELATIONS.items():
        estimate = float(correlate(*signs, once)[0])
        if math.isnan(estimate):
            return _neither("all conditions are equal in the metric or in the answers")
        draws = correlate(resampled_signs[0], resampled_signs[1], weights)
        draws = draws[~np.isnan(draws)]
        correlations[kind] = _with_interval(estimate, draws, resamples, len(present), kind, too_few)
    return correlations["kendall"], correlations["spearman"]


def _with_interval(
    estimate: float, draws: Floats, resamples: int, conditions: int, kind: Kind, too_few: str
) -> RankCorrelation:
    degenerate = resamples - len(draws)
    reason = too_few
    if conditions < FEWEST_FOR_INTERVAL:
        reason = f"{conditions} conditions are too few for an interval"
    elif not reason and len(draws) < _LEAST_USABLE * resamples:
        reason = f"{degenerate} of {resamples} resamples have no correlation"
    if reason:
        return RankCorrelation(estimate=estimate, degenerate=degenerate, reason=reason)
    low, high = percentile_interval(draws)
    least, most = compatible(estimate, conditions, kind)
    return RankCorrelation(
        estimate=estimate,
        low=max(-1.0, min(low, 2 * estimate - high, least)),
        high=min(1.0, max(high, 2 * estimate - low, most)),
        degenerate=degenerate,
    )


def _neither(reason: str) -> tuple[RankCorrelation, RankCorrelation]:
    return RankCorrelation(reason=reason), RankCorrelation(reason=reason)


def sampling_range(conditions: int) -> SamplingRange:
    """Return the range of Kendall's tau in 95% of studies of at least two conditions.

    Its true value is one half.
    """
    tau = 0.5
    chance = np.random.default_rng(_SEED)
    taus = _simulated(chance, conditions, float(np.sin(np.pi * tau / 2)), _STUDIES)["kendall"]
    low, high = percentile_interval(taus)
    return SamplingRange(tau=tau, low=low, high=high, conditions=conditions)


def compatible(estimate: float, conditions: int, kind: Kind) -> tuple[float, float]:
    """Return the range of true correlations with which `estimate` is compatible.

    Their 95% sampling ranges contain it (an interval by test inversion), so few conditions give a
    wide interval even if they agree entirely.

    Parameters
    ----------
    estimate : float
        In [-1, 1].
    conditions : int
        Number of conditions behind the estimate.
    kind : {'kendall', 'spearman'}
        Which correlation.
    """
    if estimate < 0:
        low, high = compatible(-estimate, conditions, kind)
        return -high, -low
    true, lows, highs = _sampling_ranges(conditions)[kind]
    fits = (lows <= estimate + 1e-9) & (estimate - 1e-9 <= highs)
    points = np.flatnonzero(fits)
    if not len(points):
        return estimate, estimate
    # One grid step further on both sides, because the ends lie between its points.
    low = -1.0 if fits[0] else true[points[0] - 1]
    high = 1.0 if fits[-1] else true[points[-1] + 1]
    return float(low), float(high)


@lru_cache(maxsize=64)
def _sampling_ranges(conditions: int) -> dict[Kind, tuple[Floats, Floats, Floats]]:
    """Return true correlations, in ascending order, and the ends of their sampling ranges."""
    chance = np.random.default_rng(_SEED)
    upper = [_simulated(chance, conditions, float(rho), _STUDIES_ON_GRID) for rho in _GRID]
    signed = np.concatenate([-_GRID[:0:-1], _GRID])
    true: dict[Kind, Floats] = {
        "kendall": 2 / np.pi * np.arcsin(signed),
        "spearman": 6 / np.pi * np.arcsin(signed / 2),
    }
    ranges: dict[Kind, tuple[Floats, Floats, Floats]] = {}
    for kind, truth in true.items():
        low, high = np.quantile([each[kind] for each in upper], [0.025, 0.975], axis=1)
        lows, highs = (np.concatenate([-b[:0:-1], a]) for a, b in ((low, high), (high, low)))
        ranges[kind] = truth, lows, highs
    return ranges


def _simulated(
    chance: np.random.Generator, conditions: int, rho: float, studies: int
) -> dict[Kind, Floats]:
    """Return the correlations found by `studies` studies of normal scores correlated by `rho`."""
    i, j = np.triu_indices(conditions, 1)
    taus, rhos = [], []
    block = max(1, _BLOCK // len(i))
    for start in range(0, studies, block):
        shape = (min(block, studies - start), conditions)
        first = chance.standard_normal(shape)
        second = rho * first + np.sqrt(1 - rho**2) * chance.standard_normal(shape)
        concordant = (first[:, i] > first[:, j]) == (second[:, i] > second[:, j])
        taus.append(2 * concordant.mean(axis=1) - 1)
        squares = np.square(_ranks(first) - _ranks(second)).sum(axis=1)
        rhos.append(1 - 6 * squares / (conditions * (conditions**2 - 1)))
    return {"kendall": np.concatenate(taus), "spearman": np.concatenate(rhos)}


def _ranks(values: Floats) -> Floats:
    return np.asarray(np.argsort(np.argsort(values, axis=1), axis=1), np.float64)
