"""Whether two conditions are as good as each other: two one-sided tests."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.clustered_mean import Estimate, Interval
from analysis.stats.samples import ROUNDING, finite
from motion.errors import InputError

Floats = NDArray[np.float64]
Verdict = Literal["equivalent", "different", "equivalent and different", "undecided", "unknown"]

LEVEL: Final = 0.05
"""Level of each of the two tests; the interval that decides is therefore the 90% one."""

STUDENT: Final = "two one-sided t tests"
NORMAL: Final = "two one-sided z tests"


@dataclass(frozen=True, kw_only=True)
class Equivalence(Interval):
    """Whether a difference is surely smaller than a margin.

    The interval is the 90% one; the conditions are equivalent where it lies within the margin.

    Attributes
    ----------
    margin : float
        A difference up to it does not matter: stated before the data were seen.
    standard_error, df : float
        Of the difference; infinite degrees of freedom for a normal one.
    p_value : float
        Larger one of the two one-sided p values; NaN where there is no test.
    verdict : {'equivalent', 'different', 'equivalent and different', 'undecided', 'unknown'}
        At .05. 'equivalent and different': there is a difference, too small to matter.
        'undecided' allows neither the word "comparable" nor "better"; 'unknown' where there is
        no test.
    n : int
        Independent units that it rests on; 0 where not told.
    method : str
        Which tests.
    """

    margin: float
    standard_error: float
    df: float
    p_value: float = math.nan
    verdict: Verdict = "unknown"
    n: int = 0
    method: str = ""


def equivalence(
    estimate: float, standard_error: float, margin: float, *, df: float = math.inf, n: int = 0
) -> Equivalence:
    """Test whether a difference lies within a margin (Schuirmann 1987).

    Parameters
    ----------
    estimate, standard_error : float
        A difference, 0 for none, and its error: of means, log-odds, a win share minus one half.
    margin : float
        Largest difference that does not matter, in the unit of `estimate`.
    df : float
        Degrees of freedom of the error.
    n : int
        Independent units that the estimate rests on, for the result.

    Raises
    ------
    InputError
        If the margin is not above zero, or infinite.
    """
    require_margin(margin)
    unknown = Equivalence(
        margin=margin, estimate=estimate, standard_error=standard_error, df=df, n=n
    )
    if not math.isfinite(estimate):
        return replace(unknown, reason="the difference is unknown")
    if not (math.isfinite(standard_error) and standard_error > 0):
        return replace(unknown, reason="the difference has no standard error")
    if not df > 0:
        return replace(unknown, reason="the error has no degrees of freedom")
    law = stats.t(df)
    half_width = float(law.ppf(1 - LEVEL)) * standard_error
    above = float(law.sf((estimate + margin) / standard_error))
    below = float(law.cdf((estimate - margin) / standard_error))
    different = float(2 * law.sf(abs(estimate) / standard_error)) < LEVEL
    return replace(
        unknown,
        low=estimate - half_width,
        high=estimate + half_width,
        p_value=max(above, below),
        verdict=_verdict(max(above, below) < LEVEL, different),
        method=NORMAL if math.isinf(df) else STUDENT,
    )


def require_margin(margin: float) -> None:
    """Refuse a margin that is not above zero, or infinite.

    Raises
    ------
    InputError
        With what is wrong.
    """
    if not 0 < margin < math.inf:
        raise InputError(
            f"the margin of equivalence is {margin:g}",
            remedy="State the largest difference that does not matter, above zero",
        )


def equivalence_of(estimate: Estimate, margin: float, *, null: float = 0.0) -> Equivalence:
    """Test whether an estimate with a clustered interval is as near to `null` as the margin."""
    test = equivalence(
        estimate.estimate - null, estimate.standard_error, margin, df=estimate.df, n=estimate.n
    )
    return replace(
        test,
        method=f"{test.method}, {estimate.method}" if test.method else "",
        reason=estimate.reason or test.reason,
    )


def equivalence_of_means(differences: Floats, margin: float) -> Equivalence:
    """Test whether the mean of independent differences lies within a margin.

    Parameters
    ----------
    differences : ndarray, shape (N,)
        One per participant: the mean of what they said of one condition minus that of the other.
    margin : float
        See `equivalence`.
    """
    differences = finite(differences)
    count = len(differences)
    if count < 2:
        mean = float(differences[0]) if count else math.nan
        result = equivalence(mean, math.nan, margin, n=count)
        return replace(result, df=math.nan, reason="fewer than two participants")
    spread = float(differences.std(ddof=1))
    if spread <= ROUNDING * float(np.abs(differences).max()):
        spread = 0.0
    result = equivalence(
        float(differences.mean()), spread / math.sqrt(count), margin, df=count - 1, n=count
    )
    return result if spread else replace(result, reason="all participants differ alike")


def _verdict(equivalent: bool, different: bool) -> Verdict:
    if equivalent:
        return "equivalent and different" if different else "equivalent"
    return "different" if different else "undecided"
