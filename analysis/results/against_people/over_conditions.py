"""The rank correlation of a metric with people's preference over conditions, with an interval."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.results.against_people.drawn_preferences import DrawnPreferences
from analysis.results.against_people.metric_side import MetricSide
from analysis.results.against_people.result import RankCorrelation
from analysis.results.against_people.sampling import Kind, compatible
from analysis.stats.two_way_bootstrap import times_drawn

Floats = NDArray[np.float64]

FEWEST: Final = 3
"""Two conditions always agree entirely or not at all."""

FEWEST_FOR_INTERVAL: Final = 4

_ROUNDING: Final = 1e-9
"""Scores nearer to each other, relative to the largest of all, are equal."""

_LEAST_USABLE: Final = 0.5
"""Share of resamples that must have a correlation."""

METHOD: Final = (
    "95 % interval: the widest ends of the percentiles of resamples that draw conditions, "
    "participants and segments again together, of these percentiles reflected about the estimate, "
    "and of the correlations of which the estimate would be an ordinary sample with so many "
    "conditions"
)


def order_signs(values: Floats) -> Floats:
    """Return which of every two values is the larger.

    Parameters
    ----------
    values : ndarray, shape (B, k)
        Finite.

    Returns
    -------
    ndarray, shape (B, k, k)
        1 where the value of the row is larger than that of the column, -1 where it is smaller,
        0 where they are equal but for rounding.
    """
    apart = values[:, :, None] - values[:, None, :]
    size = np.abs(values).max(axis=1, initial=0)[:, None, None]
    return np.asarray(np.sign(apart) * (np.abs(apart) > _ROUNDING * size), np.float64)


def kendall(first: Floats, second: Floats, weights: Floats) -> Floats:
    """Return Kendall's tau-b (Kendall 1945).

    Parameters
    ----------
    first, second : ndarray, shape (B, k, k)
        The order of k things in each, as `order_signs` gives it.
    weights : ndarray, shape (B, k)
        How often each of them was drawn; one drawn twice is tied with itself.

    Returns
    -------
    ndarray, shape (B,)
        NaN where all that was drawn is tied in either.
    """
    return _scaled(
        *(
            np.einsum("bi,bij,bij,bj->b", weights, one, other, weights, optimize=True)
            for one, other in ((first, second), (first, first), (second, second))
        )
    )


def spearman(first: Floats, second: Floats, weights: Floats) -> Floats:
    """Return Spearman's rho, ties having the mean of their ranks; see `kendall`."""
    ranks = [np.einsum("bij,bj->bi", signs, weights) for signs in (first, second)]
    total = weights.sum(axis=1, keepdims=True)
    centred = [one - (weights * one).sum(axis=1, keepdims=True) / total for one in ranks]
    return _scaled(
        *(
            (weights * centred[one] * centred[other]).sum(axis=1)
            for one, other in ((0, 1), (0, 0), (1, 1))
        )
    )


def _scaled(product: Floats, first: Floats, second: Floats) -> Floats:
    with np.errstate(invalid="ignore", divide="ignore"):
        found = product / np.sqrt(first * second)
    found[(first < _ROUNDING) | (second < _ROUNDING)] = np.nan
    return np.asarray(np.clip(found, -1, 1))


_CORRELATIONS: Final[Mapping[Kind, Callable[[Floats, Floats, Floats], Floats]]] = MappingProxyType(
    {"kendall": kendall, "spearman": spearman}
)


def over_conditions(
    preferences: DrawnPreferences, metric: MetricSide, *, too_few: str, seed: int
) -> tuple[RankCorrelation, RankCorrelation]:
    """Return Kendall's tau-b and Spearman's rho.

    Resampling alone gives too narrow an interval: with four conditions in one order every resample
    agrees entirely, and noise in scores and answers moves resamples towards zero a second time.
    So it is never narrower than the resamples reflected about the estimate, nor than what the
    number of conditions allows (`analysis.results.against_people.sampling.compatible`).

    Parameters
    ----------
    preferences : DrawnPreferences
        People's side.
    metric : MetricSide
        The metric, of the same conditions and segments.
    too_few : str
        Why there are no resamples of participants or segments; empty where there are.
    seed : int
        The same seed gives the same resamples.
    """
    present = metric.present
    whole = np.ones((1, preferences.segments.shape[1]))
    sides = [metric.drawn(whole), preferences.estimates[None, present]]
    if len(present) < FEWEST:
        return _neither(f"{len(present)} conditions have scores and answers; it takes {FEWEST}")
    if np.isnan(sides[1]).any():
        return _neither("the conditions fall into groups that were never compared with each other")
    drawn = [metric.drawn(preferences.segments), preferences.draws[:, present]]
    usable = np.asarray(~np.isnan(np.concatenate(drawn, axis=1)).any(axis=1))
    resamples = len(preferences.draws)
    weights = times_drawn(np.random.default_rng(seed), resamples, len(present))[usable]
    once = np.ones((1, len(present)))
    metric_signs, people_signs = map(order_signs, sides)
    metric_orders, people_orders = (order_signs(one[usable]) for one in drawn)
    found = {}
    for kind, correlation in _CORRELATIONS.items():
        estimate = float(correlation(metric_signs, people_signs, once)[0])
        if math.isnan(estimate):
            return _neither("all conditions are equal in the metric or in the answers")
        draws = correlation(metric_orders, people_orders, weights)
        draws = draws[~np.isnan(draws)]
        found[kind] = _with_interval(estimate, draws, resamples, len(present), kind, too_few)
    return found["kendall"], found["spearman"]


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
        return RankCorrelation(
            estimate=estimate, low=math.nan, high=math.nan, degenerate=degenerate, reason=reason
        )
    low, high = np.quantile(draws, [0.025, 0.975])
    least, most = compatible(estimate, conditions, kind)
    return RankCorrelation(
        estimate=estimate,
        low=float(max(-1, min(low, 2 * estimate - high, least))),
        high=float(min(1, max(high, 2 * estimate - low, most))),
        degenerate=degenerate,
    )


def _neither(reason: str) -> tuple[RankCorrelation, RankCorrelation]:
    missing = RankCorrelation(estimate=math.nan, low=math.nan, high=math.nan, reason=reason)
    return missing, missing
