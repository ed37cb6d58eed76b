"""What each test of the report decides, in words; whatever the protocol."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

from analysis.preferences.clustered import LEVEL
from analysis.report import wording
from analysis.report.headline.preference_rows import complement
from analysis.results.estimate import Estimate
from analysis.results.mismatch import MatchedCondition, MismatchResults
from analysis.results.pairwise import Comparison, PairwiseResults
from analysis.results.ranking import RankedCondition, RankingResults
from analysis.results.rating import RatingResults
from analysis.results.rating_contrasts import RatingContrast
from analysis.results.report import TableReport

SIGNIFICANCE: Final = 0.05
"""Corrected p values below this decide."""

Outcome = Literal["decided", "undecided", "untested"]


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """One test of the report.

    Attributes
    ----------
    outcome : {'decided', 'undecided', 'untested'}
        Whether the corrected test decides, or there is none.
    better, worse : str
        What is ahead in the answers, and of what; the names as they stand in the table.
    question, set : str
        What was asked; empty where there are no sets.
    numbers : str
        The estimate with its interval.
    measure : str
        What that is.
    size : float
        How far from no difference, to list the largest first; NaN for none.
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
    size: float
    reason: str

    @property
    def pair(self) -> tuple[str, str]:
        """Both names, in an order that does not depend on the answers."""
        return (self.better, self.worse) if self.better < self.worse else (self.worse, self.better)


def verdicts(report: TableReport) -> tuple[Verdict, ...]:
    """Return what every test of the report decides, in the report's order."""
    match report.results:
        case PairwiseResults(comparisons=comparisons):
            return tuple(_comparison(one) for one in comparisons)
        case MismatchResults(conditions=conditions):
            return tuple(_matched(one) for one in conditions)
        case RatingResults(contrasts=contrasts):
            return tuple(_contrast(one) for one in contrasts)
        case RankingResults():
            return ()


def leaders(results: RankingResults) -> tuple[tuple[RankedCondition, ...], ...]:
    """Return the conditions of each question of each set, the best mean rank first."""
    places = dict.fromkeys((one.set, one.question) for one in results.conditions)
    return tuple(
        tuple(
            sorted(
                (one for one in results.conditions if (one.set, one.question) == place),
                key=lambda one: one.mean_rank,
            )
        )
        for place in places
    )


def about(question: str, of: str) -> str:
    """Return the question, and the set where there are sets."""
    where = f" in set “{wording.name(of)}”" if of else ""
    return f"on {wording.name(question)}{where}"


def share_with_interval(found: Estimate) -> str:
    """Return a share with its interval, or why there is none."""
    if math.isnan(found.estimate):
        return f"– ({found.reason or 'no answers'})"
    if math.isnan(found.low):
        return f"{wording.share(found.estimate)}, no interval: {found.reason}"
    ends = f"[{wording.share(found.low)},{wording.NO_BREAK}{wording.share(found.high)}]"
    return f"{wording.share(found.estimate)}, {LEVEL:.0%} interval {ends}"


def _comparison(one: Comparison) -> Verdict:
    return _preferred(one, (one.a, one.b))


def _matched(one: MatchedCondition) -> Verdict:
    names = (
        f"{one.condition} with its own speech",
        f"{one.condition} with another's speech",
    )
    return _preferred(one, names)


def _preferred(one: Comparison | MatchedCondition, names: tuple[str, str]) -> Verdict:
    """Return which of the two that `names` calls was preferred."""
    turned = one.win_share.estimate < 0.5
    better, worse = names[::-1] if turned else names
    return Verdict(
        outcome=_outcome(one.deciding_p_holm),
        better=better,
        worse=worse,
        question=one.question,
        set=one.set or "",
        numbers=share_with_interval(complement(one.win_share) if turned else one.win_share),
        measure="win share",
        size=abs(one.win_share.estimate - 0.5),
        reason=one.clmm.reason if one.decided_by == "clmm" else one.win_share.reason,
    )


def _contrast(one: RatingContrast) -> Verdict:
    found = one.difference
    turned = found.estimate < 0
    better, worse = (one.b, one.a) if turned else (one.a, one.b)
    return Verdict(
        outcome=_outcome(found.p_holm),
        better=better,
        worse=worse,
        question=one.question,
        set=one.set or "",
        numbers=_difference_with_interval(found, turned=turned),
        measure="mean difference",
        size=abs(found.estimate),
        reason=found.reason,
    )


def _difference_with_interval(found: Estimate, *, turned: bool) -> str:
    sign = -1 if turned else 1
    estimate = wording.fixed(sign * found.estimate, 2)
    if math.isnan(found.low):
        return f"{estimate}, no interval: {found.reason}"
    low, high = sorted((sign * found.low, sign * found.high))
    ends = f"[{wording.fixed(low, 2)},{wording.NO_BREAK}{wording.fixed(high, 2)}]"
    return f"{estimate}, {LEVEL:.0%} interval {ends}"


def _outcome(p_holm: float) -> Outcome:
    if math.isnan(p_holm):
        return "untested"
    return "decided" if p_holm < SIGNIFICANCE else "undecided"


def largest_first(found: Sequence[Verdict]) -> list[Verdict]:
    """Return verdicts by size; those without one last, equal ones in their order."""
    return sorted(found, key=lambda one: -one.size if not math.isnan(one.size) else math.inf)
