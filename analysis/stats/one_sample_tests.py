"""Tests of participants' means: exact sign test, signed-rank test, and equivalence."""

import math
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.clustered_mean import Estimate, Interval
from analysis.stats.samples import ROUNDING, tied_ranks
from motion.arrays import Bools, Floats
from motion.errors import InputError

Verdict = Literal["equivalent", "different", "equivalent and different", "undecided", "unknown"]


@dataclass(frozen=True, kw_only=True)
class SignTest(Interval):
    """The share of positive values among nonzero ones, with its exact interval.

    The interval is that of Clopper & Pearson (1934).

    Attributes
    ----------
    p_value : float
        Two-sided p for a share of one half; NaN without nonzero values.
    """

    p_value: float = math.nan


def sign_test(values: Floats) -> SignTest:
    """Test whether values are above zero as often as below.

    Parameters
    ----------
    values : ndarray, shape (N,)
        One per independent unit: participants' means, not single answers.
    """
    nearly = ROUNDING * np.abs(values).max(initial=0.0)
    above, below = int((values > nearly).sum()), int((values < -nearly).sum())
    if not above + below:
        return SignTest(reason="all values are zero" if len(values) else "no values")
    test = stats.binomtest(above, above + below)
    interval = test.proportion_ci(0.95)
    return SignTest(
        estimate=above / (above + below),
        low=float(interval.low),
        high=float(interval.high),
        p_value=float(test.pvalue),
    )


EXACT: Final = 300
"""Most values for which the distribution is exact; for more, it is approximated as normal."""


IGNORED: Final = (
    "that one participant's answers resemble each other",
    "that answers about one segment resemble each other",
    "that several tests are made",
    "answers 'no difference'",
)
"""What tests of pooled answers ignore, in words that follow 'ignore'."""


@dataclass(frozen=True, kw_only=True)
class SignedRank:
    """A test whether values lie on one side of zero, by the ranks of their sizes.

    Attributes
    ----------
    p_value : float
        Two-sided; NaN if there is no test.
    reason : str
        Why there is no test; empty if there is one.
    """

    p_value: float = math.nan
    reason: str = ""


def signed_rank(values: Floats) -> SignedRank:
    """Test whether `values` are symmetric around zero (Wilcoxon 1945).

    The null distribution is over all signs of the observed ranks, with mean ranks for ties, so p is
    exact with ties too. Zeros are dropped before ranking.

    Parameters
    ----------
    values : ndarray, shape (N,)
        One per independent unit: participants' means, not single answers.
    """
    size = np.abs(values)
    nonzero = size > ROUNDING * size.max(initial=0.0)
    if not nonzero.any():
        return SignedRank(reason="all values are zero" if len(values) else "no values")
    ranks = tied_ranks(size[nonzero])
    positive = values[nonzero] > 0
    if len(ranks) <= EXACT:
        return SignedRank(p_value=_by_counting(ranks, positive))
    above = ranks[positive].sum() - ranks.sum() / 2
    deviation = math.sqrt(ranks @ ranks) / 2
    return SignedRank(p_value=float(2 * stats.norm.sf(abs(above) / deviation)))


def _by_counting(ranks: Floats, positive: Bools) -> float:
    """Return p from the exact distribution of the sum of doubled ranks with random signs."""
    doubled = np.rint(2 * ranks).astype(np.int64)
    total, above = int(doubled.sum()), int(doubled[positive].sum())
    chances = np.zeros(total + 1)
    chances[0] = 1.0
    reached = 0
    for rank in doubled.tolist():
        end = reached + rank + 1
        chances[:end] *= 0.5
        chances[rank:end] += chances[: reached + 1].copy()
        reached += rank
    return float(min(1.0, 2 * chances[: min(above, total - above) + 1].sum()))


@dataclass(frozen=True, kw_only=True)
class Pooled:
    """The tests that papers report, which treat all answers as independent.

    Attributes
    ----------
    binomial_p : float
        Sign test of wins against losses, whatever their strength.
    wilcoxon_p : float
        Signed-rank test of all answers.
    ignores : tuple of str
        What these tests ignore, as ends of a sentence.
    reason : str
        Why there are no tests; empty if there are.
    """

    binomial_p: float
    wilcoxon_p: float
    ignores: tuple[str, ...]
    reason: str


def pooled_tests(towards_first: NDArray[np.number]) -> Pooled:
    """Return the tests that papers would report for one comparison and question.

    Every answer is treated as independent. If participants or segments differ, this finds effects
    that do not exist: with standard deviations of .6 and .45 logits, 22 participants and 24
    segments, three times in ten instead of once in twenty.

    Parameters
    ----------
    towards_first : ndarray, shape (N,)
        Answers from -2 (clearly the second condition) over 0 (no difference) to 2 (clearly the
        first).
    """
    answers = np.asarray(towards_first, np.float64)
    signs = sign_test(answers)
    return Pooled(
        binomial_p=signs.p_value,
        wilcoxon_p=signed_rank(answers).p_value,
        ignores=IGNORED,
        reason=signs.reason,
    )


LEVEL: Final = 0.05
"""Level of each of the two tests; the interval that decides is therefore the 90% one."""


@dataclass(frozen=True, kw_only=True)
class Equivalence(Interval):
    """A test whether a difference is smaller than a margin.

    The interval is the 90% one; the conditions are equivalent if it lies within the margin.

    Attributes
    ----------
    margin : float
        Largest difference that does not matter, stated before the data were seen.
    standard_error, df : float
        Standard error and degrees of freedom of the difference.
    p_value : float
        The larger of the two one-sided p values; NaN without a test.
    verdict : {'equivalent', 'different', 'equivalent and different', 'undecided', 'unknown'}
        At .05. 'equivalent and different': there is a difference, but too small to matter.
        'undecided' justifies neither "comparable" nor "better"; 'unknown' if there is no test.
    n : int
        Number of answers.
    method : str
        The kind of tests.
    """

    margin: float
    standard_error: float
    df: float
    p_value: float = math.nan
    verdict: Verdict = "unknown"
    n: int = 0
    method: str = ""


def equivalence(estimate: Estimate, margin: float, *, null: float = 0.0) -> Equivalence:
    """Test whether an estimate with a clustered interval is within a margin (Schuirmann 1987).

    Parameters
    ----------
    estimate : Estimate
        A mean, a share or a difference.
    margin : float
        Largest difference from `null` that does not matter, above 0, in the unit of `estimate`.
    null : float
        The estimate if there is no difference.
    """
    difference, error = estimate.estimate - null, estimate.standard_error
    unknown = Equivalence(
        margin=margin,
        estimate=difference,
        standard_error=error,
        df=estimate.df,
        n=estimate.n,
        reason=estimate.reason,
    )
    if math.isnan(error):
        return unknown
    law = stats.t(estimate.df)
    half_width = float(law.ppf(1 - LEVEL)) * error
    above = float(law.sf((difference + margin) / error))
    below = float(law.cdf((difference - margin) / error))
    different = float(2 * law.sf(abs(difference) / error)) < LEVEL
    return replace(
        unknown,
        low=difference - half_width,
        high=difference + half_width,
        p_value=max(above, below),
        verdict=_verdict(max(above, below) < LEVEL, different),
        method=f"two one-sided t tests, {estimate.method}",
    )


def require_margin(margin: float, below: float = math.inf) -> None:
    """Refuse a margin that is not above zero and `below` the largest possible difference.

    Raises
    ------
    InputError
        If the margin is outside that range.
    """
    if not 0 < margin < below:
        limit = "" if below == math.inf else f" and below {below:g}, which no difference exceeds"
        raise InputError(
            f"the margin of equivalence is {margin:g}",
            remedy=f"State the largest difference that does not matter, above 0{limit}",
        )


def _verdict(equivalent: bool, different: bool) -> Verdict:
    if equivalent:
        return "equivalent and different" if different else "equivalent"
    return "different" if different else "undecided"
