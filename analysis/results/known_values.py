"""Estimates beside values that are known: what an analysis finds of what was put in."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

from analysis.results.mismatch import MismatchResults
from analysis.results.pairwise import PairwiseResults
from analysis.results.ranking import RankingResults
from analysis.results.rating import RatingResults
from analysis.results.report import TableReport
from analysis.stats.clustered_mean import LEVEL, Estimate

Measure = Literal["win_share", "own_speech", "mean_rating", "mean_rank"]
Sign = Literal["right", "wrong", "undecided", "equal"]

SIGNIFICANT: Final = 1 - LEVEL
"""A smaller p decides which of two ranked conditions is the better one."""

NO_RANK_INTERVAL: Final = "differences of mean ranks are tested, without an interval"


@dataclass(frozen=True, kw_only=True)
class KnownValue:
    """What simulated raters were given to prefer.

    Attributes
    ----------
    about : str
        The comparison (``first-second``) or the condition.
    part : str
        The set, block or task; empty where the study has none.
    question : str
        Name of the question.
    measure : {'win_share', 'own_speech', 'mean_rating', 'mean_rank'}
        What the number is.
    value : float
        Over all raters and all segments such as these: what an interval is an interval for.
    on_these_segments : float
        Over all raters, for the study's own segments, whose luck an estimate shares.
    """

    about: str
    part: str = ""
    question: str
    measure: Measure
    value: float
    on_these_segments: float


@dataclass(frozen=True, kw_only=True)
class Found:
    """An estimate with its interval.

    Attributes
    ----------
    estimate, low, high : float
        NaN where there is none.
    participants : int
        How many it rests on.
    reason : str
        Why a number is missing.
    """

    estimate: float
    low: float = math.nan
    high: float = math.nan
    participants: int = 0
    reason: str = ""

    @property
    def has_interval(self) -> bool:
        """Whether there is an interval."""
        return not math.isnan(self.low)

    def covers(self, value: float) -> bool:
        """Tell whether the interval holds `value`; False where there is none."""
        return self.low <= value <= self.high

    def turned(self) -> Found:
        """Return the estimate of the other side's share."""
        return replace(self, estimate=1 - self.estimate, low=1 - self.high, high=1 - self.low)


@dataclass(frozen=True, kw_only=True)
class KnownDifference:
    """Which of two is the better one, as it was put in and as the analysis says.

    Attributes
    ----------
    part, question : str
        As in `KnownValue`.
    measure : str
        'win_share', 'own_speech', or a difference: 'mean_rating' or 'mean_rank'.
    first, second : str
        The conditions; of 'own_speech', the condition with its own speech, and ``other speech``.
    truth : float
        How much better the first is, of a share from one half; below zero where it is worse. Of
        ranks, how much further in front.
    found : Found
        The same by the analysis.
    decided : bool
        Whether the analysis says that they differ.
    """

    part: str
    question: str
    measure: Measure
    first: str
    second: str
    truth: float
    found: Found
    decided: bool

    @property
    def sign(self) -> Sign:
        """Whether the analysis finds the better one.

        'equal' where neither is better in truth and none is found to be.
        """
        if not self.decided:
            return "equal" if self.truth == 0 else "undecided"
        return "right" if self.found.estimate * self.truth > 0 else "wrong"

    @property
    def half_width(self) -> float:
        """Half the width of the interval; NaN where there is none."""
        return (self.found.high - self.found.low) / 2


def found_values(
    reports: Sequence[TableReport], known: Sequence[KnownValue]
) -> tuple[tuple[KnownValue, Found], ...]:
    """Return each known value that was estimated, with its estimate."""
    pairs = []
    for report in reports:
        estimates = dict(_estimates(report))
        for value in known:
            part = value.part if report.sets else ""
            found = estimates.get((value.measure, value.about, part, value.question))
            if found is not None:
                pairs.append((value, found))
    return tuple(pairs)


def found_differences(
    reports: Sequence[TableReport], known: Sequence[KnownValue]
) -> tuple[KnownDifference, ...]:
    """Return, of any two that were compared, whether the better one is found."""
    return tuple(
        difference for report in reports for difference in _differences(report, _truths(known))
    )


_Key = tuple[str, str, str, str]
"""Measure, part, question, and what it is about."""


def _truths(known: Sequence[KnownValue]) -> dict[_Key, float]:
    return {
        (value.measure, value.part, value.question, value.about): value.value for value in known
    }


def _differences(report: TableReport, truths: Mapping[_Key, float]) -> Iterator[KnownDifference]:
    parts = {key[1] for key in truths}

    def truth(measure: Measure, part: str | None, question: str, about: str) -> float | None:
        # A table without sets may be one part of a study that has several.
        for name in [part or ""] if report.sets else sorted(parts):
            if (measure, name, question, about) in truths:
                return truths[measure, name, question, about]
        return None

    match report.results:
        case PairwiseResults(comparisons=comparisons):
            for pair in comparisons:
                for first, second, found in (
                    (pair.a, pair.b, _of(pair.win_share)),
                    (pair.b, pair.a, _of(pair.win_share).turned()),
                ):
                    share = truth("win_share", pair.set, pair.question, f"{first}-{second}")
                    if share is not None:
                        names = (pair.set or "", pair.question, first, second)
                        yield _from_half("win_share", names, share, found)
        case MismatchResults(conditions=matched):
            for own in matched:
                share = truth("own_speech", own.set, own.question, own.condition)
                if share is not None:
                    names = (own.set or "", own.question, own.condition, "other speech")
                    yield _from_half("own_speech", names, share, _of(own.win_share))
        case RatingResults(contrasts=contrasts):
            for one in contrasts:
                values = [
                    truth("mean_rating", one.set, one.question, name) for name in (one.a, one.b)
                ]
                if values[0] is not None and values[1] is not None:
                    found = _of(one.difference)
                    yield KnownDifference(
                        part=one.set or "",
                        question=one.question,
                        measure="mean_rating",
                        first=one.a,
                        second=one.b,
                        truth=values[0] - values[1],
                        found=found,
                        decided=found.has_interval and not found.covers(0.0),
                    )
        case RankingResults(posthoc=posthoc):
            for ranks in posthoc:
                values = [
                    truth("mean_rank", ranks.set, ranks.question, name)
                    for name in (ranks.a, ranks.b)
                ]
                if values[0] is not None and values[1] is not None:
                    yield KnownDifference(
                        part=ranks.set or "",
                        question=ranks.question,
                        measure="mean_rank",
                        first=ranks.a,
                        second=ranks.b,
                        truth=values[1] - values[0],
                        found=Found(
                            estimate=-ranks.difference,
                            participants=ranks.n,
                            reason=ranks.reason or NO_RANK_INTERVAL,
                        ),
                        decided=ranks.conover_holm < SIGNIFICANT,
                    )


def _from_half(
    measure: Measure, names: tuple[str, str, str, str], share: float, found: Found
) -> KnownDifference:
    part, question, first, second = names
    return KnownDifference(
        part=part,
        question=question,
        measure=measure,
        first=first,
        second=second,
        truth=share - 0.5,
        found=replace(
            found, estimate=found.estimate - 0.5, low=found.low - 0.5, high=found.high - 0.5
        ),
        decided=found.has_interval and not found.covers(0.5),
    )


def _estimates(report: TableReport) -> Iterator[tuple[tuple[str, str, str, str], Found]]:
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
                    _of(rating),
                )
        case RankingResults(conditions=ranked):
            for one in ranked:
                key = "mean_rank", one.condition, one.set or "", one.question
                yield key, _of(one.mean_rank)


def _of(found: Estimate) -> Found:
    return Found(
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        participants=found.participants,
        reason=found.reason,
    )
