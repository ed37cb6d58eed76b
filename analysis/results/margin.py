"""Whether two conditions are as good as each other, within a margin stated beforehand."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.results.estimate import Estimate
from analysis.results.place import PairPlace
from analysis.stats.equivalence import Equivalence, equivalence


@dataclass(frozen=True, kw_only=True)
class Equivalent(PairPlace):
    """Two one-sided tests of a difference against a margin.

    Attributes
    ----------
    margin : float
        Largest difference that does not matter.
    estimate, low, high : float
        The difference and its 90 % interval, which decides.
    p : float
        The larger one of the two p values.
    verdict : str
        'equivalent', 'different', 'equivalent and different', 'undecided' or 'unknown'.
    method, reason : str
        Which tests; why there is none.
    """

    margin: float
    estimate: float
    low: float
    high: float
    p: float
    verdict: str
    method: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class MarginTest:
    """Two one-sided tests of another estimate of the same difference.

    Attributes
    ----------
    estimate, low, high, p : float
        As in `Equivalent`.
    verdict, method, reason : str
        As in `Equivalent`.
    """

    estimate: float
    low: float
    high: float
    p: float
    verdict: str
    method: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class RatedEquivalent(Equivalent):
    """Two one-sided tests of participants' means, which take the segments as the only ones.

    Attributes
    ----------
    two_way : MarginTest
        Of the mean difference of paired ratings, for which segments are a sample too; the
        headline.
    """

    two_way: MarginTest


def margin_test(difference: Estimate, margin: float) -> MarginTest:
    """Test a two-way clustered difference against a margin."""
    found = equivalence(
        difference.estimate,
        difference.se,
        margin,
        freedom=difference.df,
    )
    return MarginTest(
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        p=found.p_value,
        verdict=found.verdict,
        method=f"{found.method}, {difference.method}" if found.method else "",
        reason=difference.reason or found.reason,
    )


def equivalent(
    difference: float, error: float, margin: float, *, freedom: float, reason: str, of: PairPlace
) -> Equivalent:
    """Test a difference against a margin.

    Parameters
    ----------
    difference, error : float
        0 for none, and its standard error; NaN where it is unknown.
    margin : float
        Above zero, in the same unit.
    freedom : float
        Degrees of freedom of the error.
    reason : str
        Why there is no error, if there is none.
    of : PairPlace
        What it is about.
    """
    return within_margin(equivalence(difference, error, margin, freedom=freedom), of, reason)


def within_margin(found: Equivalence, of: PairPlace, reason: str = "") -> Equivalent:
    """Return a test of equivalence under the names of `results.json`."""
    return Equivalent(
        **vars(of),
        margin=found.upper_margin,
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        p=found.p_value,
        verdict=found.verdict,
        method=found.method,
        reason=reason or found.reason,
    )
