"""Link functions of ordered answers: the probability of an interval, and its derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit, ndtr

Floats = NDArray[np.float64]
Link = Literal["logit", "probit"]

SMALLEST: Final = 1e-300
"""Probabilities below it are taken for it: their logarithm must exist."""


@dataclass(frozen=True)
class Interval:
    """The probability p = F(upper end) - F(lower end) of each answer, all of shape (N,).

    With f the density of F:

    Attributes
    ----------
    log_probability : ndarray
        log p.
    upper, lower : ndarray
        f(upper end) / p and -f(lower end) / p.
    at_upper, at_lower : ndarray
        Where the ends are: F there for the logit, the end itself for the probit.
    link : {'logit', 'probit'}
        Distribution F.
    """

    log_probability: Floats
    upper: Floats
    lower: Floats
    at_upper: Floats
    at_lower: Floats
    link: Link

    @cached_property
    def upper1(self) -> Floats:
        """f'(upper end) / p."""
        return self.upper * _first(self.at_upper, self.link)

    @cached_property
    def lower1(self) -> Floats:
        """-f'(lower end) / p."""
        return self.lower * _first(self.at_lower, self.link)

    @cached_property
    def upper2(self) -> Floats:
        """f''(upper end) / p."""
        return self.upper * _second(self.at_upper, self.link)

    @cached_property
    def lower2(self) -> Floats:
        """-f''(lower end) / p."""
        return self.lower * _second(self.at_lower, self.link)


def interval(lower: Floats, upper: Floats, link: Link) -> Interval:
    """Return the probability of lower < latent <= upper with its derivatives.

    Parameters
    ----------
    lower, upper : ndarray, shape (N,)
        Ends; the lowest and the highest may be infinite, `lower` is below `upper`.
    link : {'logit', 'probit'}
        Distribution of the latent scale.
    """
    return _logistic(lower, upper) if link == "logit" else _normal(lower, upper)


def _logistic(lower: Floats, upper: Floats) -> Interval:
    # F(u) - F(l) = F(u) F(-l) (1 - exp(l - u)) keeps its digits in both tails.
    below, above = expit(upper), expit(-lower)
    gap = -np.expm1(lower - upper)
    probability = np.maximum(below * above * gap, SMALLEST)
    return Interval(
        log_probability=np.log(probability),
        upper=(1 - below) / (above * gap),
        lower=-(1 - above) / (below * gap),
        at_upper=below,
        at_lower=1 - above,
        link="logit",
    )


def _normal(lower: Floats, upper: Floats) -> Interval:
    # Far in the upper tail 1 - F loses all digits: there the mirrored interval is taken.
    mirrored = lower + upper > 0
    low, high = np.where(mirrored, -upper, lower), np.where(mirrored, -lower, upper)
    probability = np.maximum(ndtr(high) - ndtr(low), SMALLEST)
    at_upper, at_lower = (np.where(np.isfinite(end), end, 0.0) for end in (upper, lower))
    scale = probability * np.sqrt(2 * np.pi)
    return Interval(
        log_probability=np.log(probability),
        upper=np.isfinite(upper) * np.exp(-0.5 * at_upper**2) / scale,
        lower=np.isfinite(lower) * -np.exp(-0.5 * at_lower**2) / scale,
        at_upper=at_upper,
        at_lower=at_lower,
        link="probit",
    )


def _first(at: Floats, link: Link) -> Floats:
    """Return f' / f."""
    return 1 - 2 * at if link == "logit" else -at


def _second(at: Floats, link: Link) -> Floats:
    """Return f'' / f."""
    return 1 - 6 * at * (1 - at) if link == "logit" else at**2 - 1
