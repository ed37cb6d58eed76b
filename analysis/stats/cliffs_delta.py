"""Cliff's delta: how often one condition is rated higher than another, minus how often lower."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.clustered_mean import LEVEL, Clusters, Estimate, with_interval
from analysis.stats.values import finite

Floats = NDArray[np.float64]


def cliffs_delta(
    values: NDArray[np.number],
    of_first: NDArray[np.bool_],
    participants: NDArray[np.generic],
    segments: NDArray[np.generic],
) -> Estimate:
    """Compare the ratings of two conditions (Cliff 1993).

    The error is not Cliff's, who takes all ratings as independent: what each rating adds to
    delta is clustered by participant and segment as for a win share; interval and test are made on
    the scale of Fisher's z.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Ratings of two conditions.
    of_first : ndarray of bool, shape (N,)
        Which of them are of the first.
    participants, segments : ndarray, shape (N,)
        Who rated what.
    """
    y = finite(values)
    clusters = Clusters.of(participants, segments)
    first, second = int(of_first.sum()), int((~of_first).sum())
    if not (first and second):
        return clusters.unknown("one of the conditions has no ratings")
    dominance = np.where(of_first, _above(y, y[~of_first]), -_above(y, y[of_first]))
    estimate = float(dominance[of_first].mean())
    found = replace(clusters.unknown(), estimate=estimate)
    if found.participants < 2:
        return replace(found, reason="one participant")
    if abs(estimate) == 1:
        return replace(found, reason="the ratings do not overlap")
    sizes = np.where(of_first, first, second).astype(np.float64)
    influences = (dominance - estimate) / sizes
    if not influences.any():
        return replace(found, reason="all ratings alike")
    found = with_interval(found, influences, clusters, weights=sizes**-2)
    law, middle = stats.t(found.df), math.atanh(estimate)
    error = found.standard_error / (1 - estimate**2)
    margin = float(law.ppf((1 + LEVEL) / 2)) * error
    return replace(
        found,
        low=math.tanh(middle - margin),
        high=math.tanh(middle + margin),
        p_value=float(2 * law.sf(abs(middle) / error)),
    )


def _above(values: Floats, others: Floats) -> Floats:
    """Return, for each value, the share of `others` below it minus the share above it."""
    order = np.sort(others)
    below = np.searchsorted(order, values, side="left")
    above = len(order) - np.searchsorted(order, values, side="right")
    return np.asarray((below - above) / len(order), np.float64)
