"""The precision of a printed share when participants and items differ.

A paper that prints only percentages does not show how much participants and items differ in their
preferences. This module computes, for any such spread, the interval that the same answers would
have had.

The model is a latent difference: a mean, plus a normal deviation for each participant, one for each
item, and a logistic one for each answer, with a middle zone that is answered 'no difference'. Mean
and zone reproduce the printed wins and losses for every spread. Everybody answers about every item.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from scipy import stats
from scipy.optimize import brentq
from scipy.special import expit

_NODES, _WEIGHTS = hermegauss(61)
_WEIGHTS = _WEIGHTS / _WEIGHTS.sum()
_FARTHEST: Final = 60.0
"""Bound on latent differences, in logits."""


@dataclass(frozen=True, kw_only=True)
class Spread:
    """The variation of a preference, in logits.

    Attributes
    ----------
    participants, items : float
        Standard deviation between participants, and between items.
    """

    participants: float
    items: float


@dataclass(frozen=True, kw_only=True)
class SharedAnswers:
    """The precision of a printed win share under some spread.

    Attributes
    ----------
    win_share : float
        The printed share, with a tie counting one half.
    low, high : float
        The expected 95% interval.
    p_value : float
        Two-sided p of one half, from the same t distribution.
    design_effect : float
        Variance of the win share relative to that of as many independent answers.
    """

    win_share: float
    low: float
    high: float
    p_value: float
    design_effect: float


def with_spread(
    wins: float, losses: float, *, participants: int, items: int, spread: Spread
) -> SharedAnswers:
    """Compute the interval of a win share, given how much participants and items differ.

    Parameters
    ----------
    wins, losses : float
        Shares of all answers, each above 0 and together at most 1.
    participants, items : int
        Number of each, at least two.
    spread : Spread
        The spread of their preferences.

    Notes
    -----
    The variance of a mean over a crossed design is V_p / P + V_i / I + V_r / (P I), where V_p and
    V_i are the variances of participants' and items' own means and V_r is the rest (Cornfield &
    Tukey 1956). The interval takes t with min(P, I) - 1 degrees of freedom, as the report does.
    """
    total = math.hypot(spread.participants, spread.items)
    below = _quantile(wins, total)
    above = _quantile(losses, total)
    middle, zone = (below - above) / 2, -(below + above) / 2
    share = (1 + wins - losses) / 2
    variance = wins + (1 - wins - losses) / 4 - share**2
    of_participants = _variance_of_means(middle, zone, spread.participants, spread.items)
    of_items = _variance_of_means(middle, zone, spread.items, spread.participants)
    rest = variance - of_participants - of_items
    of_mean = of_participants / participants + of_items / items + rest / (participants * items)
    error = math.sqrt(of_mean)
    degrees = min(participants, items) - 1
    reach = float(stats.t.ppf(0.975, degrees)) * error
    return SharedAnswers(
        win_share=share,
        low=share - reach,
        high=share + reach,
        p_value=float(2 * stats.t.sf(abs(share - 0.5) / error, degrees)),
        design_effect=of_mean / (variance / (participants * items)),
    )


def _chance(latent: np.ndarray | float, spread: float) -> np.ndarray:
    """Return the probability that a logistic plus a normal deviation is below `latent`."""
    shifted = np.asarray(latent)[..., None] + spread * _NODES
    return np.asarray(expit(shifted) @ _WEIGHTS)


def _quantile(chance: float, spread: float) -> float:
    """Return the latent value whose `_chance` is `chance`."""
    found = brentq(lambda x: float(_chance(x, spread)) - chance, -_FARTHEST, _FARTHEST)
    return float(found)


def _variance_of_means(middle: float, zone: float, own: float, other: float) -> float:
    """Return the variance of the mean outcomes of participants (or items) that differ by `own`."""
    latent = middle + own * _NODES
    means = (1 + _chance(latent - zone, other) - _chance(-latent - zone, other)) / 2
    mean = float(_WEIGHTS @ means)
    return float(_WEIGHTS @ (means - mean) ** 2)
