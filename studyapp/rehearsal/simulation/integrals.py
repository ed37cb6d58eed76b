"""What very many raters would answer on average, integrated over everything that differs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from scipy.special import expit

from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.scales import rating_thresholds

NODES, WEIGHTS = hermegauss(61)


def win_share(population: Population, gap: float, slope_sd: float, *, ties: bool = True) -> float:
    """Return the expected wins plus half the ties of the better side of a pair.

    Each side is taken to be the left one half the time. An answer rests on
    ``s * (gap + slope) + bias + noise`` with ``s = 1`` where the first condition is on the right;
    as slope and bias are normal and independent, their sum is one normal, integrated over by
    Gauss-Hermite quadrature.

    Parameters
    ----------
    population : Population
        Gives thresholds and side bias.
    gap : float
        Mean difference in quality, first condition minus second, in logits.
    slope_sd : float
        Standard deviation of that difference over what the share averages over, in logits.
    ties : bool
        Whether 'no difference' can be answered.

    Returns
    -------
    float
        Share of the first condition in [0, 1]; .5 where `gap` is 0.
    """
    spread = math.hypot(slope_sd, population.side_bias_sd)
    tie = population.weak if ties else 0.0
    total = 0.0
    for side in (1.0, -1.0):
        mean = side * gap + population.side_bias
        share_of_right = averaged(lambda latent: _share_of_right(latent, tie), mean, spread)
        total += share_of_right if side > 0 else 1 - share_of_right
    return total / 2


def mean_rating(
    population: Population, quality: float, spread: float, values: Sequence[int]
) -> float:
    """Return the expected rating of one condition.

    Parameters
    ----------
    population : Population
        Gives the borders between the steps.
    quality : float
        Mean utility in logits.
    spread : float
        Standard deviation of the utility over what the mean averages over, leniency of the
        raters included, in logits.
    values : sequence of int
        The steps of the scale, evenly spaced from the worst to the best.
    """
    borders = np.asarray(rating_thresholds(population, len(values)))[:, None]
    steps = averaged(lambda latent: expit(latent - borders).sum(axis=0), quality, spread)
    return values[0] + steps * (values[1] - values[0])


def mean_rank(gaps: Sequence[float], slope_sd: float) -> float:
    """Return the expected rank, counted from 1, among others, where nothing shares a rank.

    Parameters
    ----------
    gaps : sequence of float
        Mean difference in utility to each of the others, this one minus the other, in logits.
    slope_sd : float
        Standard deviation of each difference over what the mean averages over, in logits.
    """
    return 1 + sum(averaged(lambda lead: expit(-lead), gap, slope_sd) for gap in gaps)


def averaged(function: Callable[[np.ndarray], np.ndarray], mean: float, spread: float) -> float:
    """Return the mean of `function` over a normal variable, by Gauss-Hermite quadrature."""
    return float(WEIGHTS @ function(mean + spread * NODES) / WEIGHTS.sum())


def _share_of_right(latent: np.ndarray, tie: float) -> np.ndarray:
    """Return wins of the right side plus half the ties, with logistic noise around `latent`."""
    above, not_below = expit(latent - tie), expit(latent + tie)
    return np.asarray(above + (not_below - above) / 2)
