"""The section that holds a rehearsal's estimates against what its raters were given."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final

from analysis.preferences.clustered import LEVEL
from analysis.report import wording
from analysis.report.by_question import question_name
from analysis.report.content import Cell, Section, Table
from analysis.report.subject import KnownValue, Subject
from analysis.results.estimate import Estimate
from analysis.results.mismatch import MismatchResults
from analysis.results.pairwise import PairwiseResults
from analysis.results.ranking import RankingResults
from analysis.results.rating import RatingResults
from analysis.results.report import TableReport

MEASURES: Final = MappingProxyType(
    {
        "win_share": "win share of the first",
        "own_speech": "win share of the own speech",
        "mean_rating": "mean rating",
        "mean_rank": "mean rank",
    }
)


@dataclass(frozen=True, kw_only=True)
class _Found:
    """An estimate to be held against a known value."""

    estimate: float
    low: float
    high: float
    reason: str

    def turned(self) -> _Found:
        """Return the estimate of the other side's share."""
        return replace(self, estimate=1 - self.estimate, low=1 - self.high, high=1 - self.low)


def truth_section(reports: Sequence[TableReport], subject: Subject) -> Section | None:
    """Return how a rehearsal's estimates compare with what its raters were given."""
    pairs = [pair for report in reports for pair in _pairs(report, subject)]
    if not pairs:
        return None
    inside = sum(_covers(found, known) for known, found in pairs)
    with_interval = sum(not math.isnan(found.low) for _, found in pairs)
    return Section(
        anchor="truth",
        heading="Known truth against estimate",
        paragraphs=(
            f"Simulated raters prefer by rule, so the true values are known. {inside} of "
            f"{wording.count(with_interval, 'interval')} contain theirs. In the long run about "
            f"{LEVEL:.0%} should, so that one or more of {with_interval} may miss it in up to "
            f"{100 * (1 - LEVEL**with_interval):.0f} of 100 rehearsals.",
        ),
        tables=(
            Table(
                caption="What the simulated raters were given to prefer, and its estimate after "
                "exclusions. The interval speaks of all segments such as these; which ones were "
                "drawn moves the estimate towards the last column.",
                header=(
                    *("question", "of", "number", "truth", "estimate"),
                    *(f"{LEVEL:.0%} interval", "truth is", "truth for these segments"),
                ),
                rows=tuple(_row(known, found) for known, found in pairs),
                text_columns=3,
                name="truth",
            ),
        ),
    )


def _row(known: KnownValue, found: _Found) -> tuple[Cell, ...]:
    where = "no interval" if math.isnan(found.low) else "outside"
    ends = found.reason or "none"
    if not math.isnan(found.low):
        ends = f"[{_number(found.low)},{wording.NO_BREAK}{_number(found.high)}]"
    return (
        Cell(text=question_name(known.part, known.question)),
        Cell(text=wording.name(known.about)),
        Cell(text=MEASURES[known.measure]),
        Cell(text=_number(known.value), value=known.value),
        Cell(text=_number(found.estimate), value=found.estimate),
        Cell(text=ends),
        Cell(text="inside" if _covers(found, known) else where),
        Cell(text=_number(known.on_these_segments), value=known.on_these_segments),
    )


def _covers(found: _Found, known: KnownValue) -> bool:
    return found.low <= known.value <= found.high


def _number(value: float) -> str:
    return wording.fixed(value, 2)


def _pairs(report: TableReport, subject: Subject) -> Iterator[tuple[KnownValue, _Found]]:
    estimates = dict(_estimates(report))
    for known in subject.truth:
        part = known.part if report.sets else ""
        found = estimates.get((known.measure, known.about, part, known.question))
        if found is not None:
            yield known, found


def _estimates(report: TableReport) -> Iterator[tuple[tuple[str, str, str, str], _Found]]:
    """Give every estimate that a rehearsal knows the truth of, both ways round for pairs."""
    match report.results:
        case PairwiseResults(comparisons=comparisons):
            for pair in comparisons:
                place = pair.set or "", pair.question
                share = _of(pair.win_share)
                yield ("win_share", f"{pair.a}-{pair.b}", *place), share
                yield ("win_share", f"{pair.b}-{pair.a}", *place), share.turned()
        case MismatchResults(conditions=matched):
            for own in matched:
                key = "own_speech", own.condition, own.set or "", own.question
                yield key, _of(own.win_share)
        case RatingResults(conditions=rated):
            for rating in rated:
                yield (
                    ("mean_rating", rating.condition, rating.set or "", rating.question),
                    _Found(
                        estimate=rating.mean, low=rating.low, high=rating.high, reason=rating.reason
                    ),
                )
        case RankingResults(conditions=ranked):
            for one in ranked:
                key = "mean_rank", one.condition, one.set or "", one.question
                yield key, _of(one.mean_rank_interval)


def _of(found: Estimate) -> _Found:
    return _Found(estimate=found.estimate, low=found.low, high=found.high, reason=found.reason)
