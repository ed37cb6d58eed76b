"""The exact sign test: how many values are above zero, whatever their size."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.values import ROUNDING, finite

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class SignTest:
    """How many values are above zero.

    Attributes
    ----------
    estimate : float
        Share of the values above zero among those that are not zero; NaN without any.
    low, high : float
        Ends of its exact 95 % interval (Clopper & Pearson 1934); NaN without any.
    p_value : float
        Two-sided p of the share being one half; NaN without any.
    above, below, zeros : int
        Number of values.
    method : str
        Which test; empty where there is none.
    reason : str
        Why there is no test; empty where there is one.
    """

    estimate: float = math.nan
    low: float = math.nan
    high: float = math.nan
    p_value: float = math.nan
    above: int
    below: int
    zeros: int
    method: str = ""
    reason: str = ""


def sign_test(values: Floats) -> SignTest:
    """Test whether values lie above zero as often as below it.

    Parameters
    ----------
    values : ndarray, shape (N,)
        One per independent unit: participants' means, not single answers.
    """
    values = finite(values)
    nearly = ROUNDING * np.abs(values).max(initial=0.0)
    above, below = int((values > nearly).sum()), int((values < -nearly).sum())
    zeros = len(values) - above - below
    if not above + below:
        reason = "all values are zero" if zeros else "no values"
        return SignTest(above=above, below=below, zeros=zeros, reason=reason)
    test = stats.binomtest(above, above + below)
    interval = test.proportion_ci(0.95)
    return SignTest(
        estimate=above / (above + below),
        low=float(interval.low),
        high=float(interval.high),
        p_value=float(test.pvalue),
        above=above,
        below=below,
        zeros=zeros,
        method="exact binomial, zeros dropped",
    )
