"""What each test of the report decides, in words; whatever the protocol."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

from analysis.report import wording
from analysis.report.wording import between, number
from analysis.results.grouping import PairPlace
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.preference import Comparison, MatchedCondition
from analysis.results.ranking import RankingResults
from analysis.results.rating import RatingResults
from analysis.results.rating_contrasts import RatingContrast
from analysis.results.report import TableReport
from analysis.results.strengths import StrengthContrast
from analysis.stats.clustered_mean import LEVEL

SIGNIFICANCE: Final = 0.05
"""Corrected p values below this decide."""

Outcome = Literal["decided", "undecided", "untested", "outside"]

MEASURES: Final = MappingProxyType(
    {"clmm": "log-odds", "win_share": "win share", "sign": "share of participants"}
)
"""What each test of a preference is quoted by."""


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """One test of the report.

    Attributes
    ----------
    outcome : {'decided', 'undecided', 'untested', 'outside'}
        Whether the corrected test decides, or there is none, or it is not of the report's family.
    better, worse : str
        What is ahead in the answers, and of what, as readers know them.
    question, set : str
        What was asked; empty where there are no sets.
    numbers : str
        The estimate that the test is about, with its interval.
    measure : str
        What that is.
    apart : bool
        Whether the interval leaves out no difference.
    size : float
        How far from no difference, to list the largest first; NaN for none.
    why : str
        Why this test stands in for the usual one; empty where it does not.
    reason : str
        Why there is no test.
    """

    outcome: Outcome
    better: str
    worse: str
    question: str
    set: str
    numbers: str
    measure: str
    apart: bool
    size: float
    why: str = ""
    reason: str = ""

    @property
    def pair(self) -> tuple[str, str]:
        """Both names, in an order that does not depend on the answers."""
        return (self.better, self.worse) if self.better < self.worse else (self.worse, self.better)


def verdicts(report: TableReport) -> tuple[Verdict, ...]:
    """Return what every test of the report decides, in the report's order."""
    match report.results:
        case PairwiseResults() as results:
            if results.decided_by == "strengths":
                return tuple(_stronger(one, "strengths") for one in results.contrasts)
            return tuple(
                _preferred(one, (wording.condition(one.a), wording.condition(one.b)))
                for one in results.comparisons
            )
        case MismatchResults(conditions=conditions):
            return tuple(_matched(one) for one in conditions)
        case RatingResults(contrasts=contrasts):
            return tuple(_contrast(one) for one in contrasts)
        case RankingResults(contrasts=ranked):
            return tuple(_stronger(one, "worths") for one in ranked)


def about(question: str, of: str) -> str:
    """Return the question, and the set where there are sets."""
    where = f" in set “{wording.name(of)}”" if of else ""
    return f"on {wording.name(question)}{where}"


def _matched(one: MatchedCondition) -> Verdict:
    names = (
        f"{wording.condition(one.condition)} with its own speech",
        f"{wording.condition(one.condition)} with another's speech",
    )
    return _preferred(one, names)


def _preferred(one: Comparison | MatchedCondition, names: tuple[str, str]) -> Verdict:
    """Return which of the two that `names` calls was preferred, by what decides."""
    found = one.decision
    turned = found.estimate < found.null
    better, worse = names[::-1] if turned else names
    seen = found.turned() if turned else found
    return Verdict(
        outcome=_outcome(found.p_value, found.p_holm),
        better=better,
        worse=worse,
        question=one.question,
        set=one.set or "",
        numbers=_with_interval(
            seen.estimate,
            (seen.low, seen.high),
            wording.share if found.null else number,
            one.win_share.reason,
        ),
        measure=MEASURES[found.by],
        apart=_leaves_out(found.null, found.low, found.high),
        size=abs(one.win_share.estimate - 0.5),
        why=found.why,
        reason=found.reason,
    )


def _contrast(one: RatingContrast) -> Verdict:
    found = one.difference
    return _difference(
        one,
        found.estimate,
        (found.low, found.high),
        _outcome(found.p_value, found.p_holm),
        measure="mean difference",
        reason=found.reason,
    )


def _stronger(one: StrengthContrast, what: str) -> Verdict:
    return _difference(
        one,
        one.estimate,
        (one.low, one.high),
        _outcome(one.p_value, one.p_holm),
        measure=f"difference of {what} in logits",
        why=one.remark,
        reason=one.reason or (NO_END if one.by == "sign" else ""),
    )


def _difference(
    of: PairPlace,
    estimate: float,
    ends: tuple[float, float],
    outcome: Outcome,
    *,
    measure: str,
    why: str = "",
    reason: str = "",
) -> Verdict:
    turned = estimate < 0
    names = wording.condition(of.a), wording.condition(of.b)
    better, worse = names[::-1] if turned else names
    sign = -1 if turned else 1
    low, high = sorted(sign * end for end in ends)
    return Verdict(
        outcome=outcome,
        better=better,
        worse=worse,
        question=of.question,
        set=of.set or "",
        numbers=_with_interval(sign * estimate, (low, high), number, reason),
        measure=measure,
        apart=_leaves_out(0.0, *ends),
        size=abs(estimate),
        why=why,
        reason=reason,
    )


NO_END: Final = "one of the two never lost to the other"


def _with_interval(
    estimate: float, ends: tuple[float, float], written: Callable[[float], str], reason: str
) -> str:
    """Return an estimate with its interval, or why there is none."""
    if math.isnan(estimate):
        return f"– ({reason or 'no answers'})"
    if math.isnan(ends[0]):
        return f"{written(estimate)}, no interval: {reason}"
    low, high = map(written, ends)
    return f"{written(estimate)}, {LEVEL:.0%} interval {between(low, high)}"


def _leaves_out(null: float, low: float, high: float) -> bool:
    return low > null or high < null


def _outcome(p: float, p_holm: float) -> Outcome:
    if math.isnan(p):
        return "untested"
    if math.isnan(p_holm):
        return "outside"
    return "decided" if p_holm < SIGNIFICANCE else "undecided"


def largest_first(found: Sequence[Verdict]) -> list[Verdict]:
    """Return verdicts by size; those without one last, equal ones in their order."""
    return sorted(found, key=lambda one: -one.size if not math.isnan(one.size) else math.inf)
