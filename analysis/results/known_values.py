"""Estimates beside values that are known: what an analysis finds of true values."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

from analysis.results.grouping import Place
from analysis.results.headline import Measure
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.ranking import RankingResults
from analysis.results.rating import RatingResults
from analysis.results.report import TableReport
from analysis.stats.clustered_mean import LEVEL, Estimate

Sign = Literal["right", "wrong", "undecided", "equal"]

SIGNIFICANT: Final = 1 - LEVEL
"""A smaller p decides which of two ranked conditions is the better one."""

NO_RANK_INTERVAL: Final = "differences of mean ranks are tested, without an interval"


@dataclass(frozen=True, kw_only=True)
class KnownValue:
    """A true value: what simulated raters prefer.

    Attributes
    ----------
    about : str
        The comparison (``first-second``) or the condition.
    part : str
        The set, block or task; empty where the study has none.
    question : str
        Name of the question.
    measure : {'win_share', 'own_speech', 'mean_rating', 'mean_rank'}
        Wins plus half the ties of the first condition of a comparison, in [0, 1]; the same of a
        motion with its own speech against itself with another, in [0, 1]; the mean rating, on the
        question's scale; the mean rank, 1 the best.
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
class KnownDifference:
    """Which of two is the better one, by the true values and as the analysis says.

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
    found : Estimate
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
    found: Estimate
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
) -> tuple[tuple[KnownValue, Estimate], ...]:
    """Return each known value that was estimated, with its estimate."""
    return tuple(
        (value, found)
        for report in reports
        for estimates in ({_key(*one[:2]): one[2] for one in _estimates(report)},)
        for value in known
        if (found := estimates.get(_key_of(value, value.part if report.sets else ""))) is not None
    )


def found_differences(
    reports: Sequence[TableReport], known: Sequence[KnownValue]
) -> tuple[KnownDifference, ...]:
    """Return, of any two that were compared, whether the better one is found."""
    truths = {_key_of(value, value.part): value.value for value in known}
    return tuple(
        difference
        for report in reports
        for one in _compared(report)
        if not math.isnan((difference := _difference(report, truths, *one)).truth)
    )


_Key = tuple[str, str, str, str]
"""Measure, part, question, and what it is about."""


def _key(measure: Measure, place: Place) -> _Key:
    return measure, place.set or "", place.question, "-".join(place.names)


def _key_of(value: KnownValue, part: str) -> _Key:
    return value.measure, part, value.question, value.about


def _estimates(report: TableReport) -> Iterator[tuple[Measure, Place, Estimate]]:
    """Give every headline number of a report, both ways round for pairs."""
    match report.results:
        case PairwiseResults(comparisons=comparisons):
            for pair in comparisons:
                for one in (pair, pair.mirrored()):
                    yield "win_share", one, one.win_share
        case MismatchResults(conditions=matched):
            for own in matched:
                yield "own_speech", own, own.win_share
        case RatingResults(conditions=rated):
            for rating in rated:
                yield "mean_rating", rating, rating
        case RankingResults(conditions=ranked):
            for rank in ranked:
                yield "mean_rank", rank, rank.mean_rank


def _compared(report: TableReport) -> Iterator[tuple[Measure, Place, Estimate, bool]]:
    """Give what the analysis says of every two: shares as differences from one half."""
    match report.results:
        case RatingResults(contrasts=contrasts):
            for one in contrasts:
                found = one.difference
                yield "mean_rating", one, found, found.has_interval and not found.covers(0.0)
        case RankingResults(posthoc=posthoc):
            for pair in posthoc:
                reason = pair.reason or NO_RANK_INTERVAL
                ahead = Estimate(estimate=-pair.difference, participants=pair.n, reason=reason)
                yield "mean_rank", pair, ahead, pair.conover_holm < SIGNIFICANT
        case _:
            for measure, place, share in _estimates(report):
                moved = {name: getattr(share, name) - 0.5 for name in ("estimate", "low", "high")}
                decided = share.has_interval and not share.covers(0.5)
                yield measure, place, replace(share, **moved), decided


def _difference(
    report: TableReport,
    truths: Mapping[_Key, float],
    measure: Measure,
    place: Place,
    found: Estimate,
    decided: bool,
) -> KnownDifference:
    # A table without sets may be one part of a study that has several.
    parts = [place.set or ""] if report.sets else sorted({key[1] for key in truths})
    is_share = measure in ("win_share", "own_speech")
    keys = [
        next((k for part in parts if (k := (measure, part, place.question, name)) in truths), None)
        for name in (["-".join(place.names)] if is_share else place.names)
    ]
    first, second = [*(truths[key] if key else math.nan for key in keys), 0.5][:2]
    return KnownDifference(
        part=place.set or "",
        question=place.question,
        measure=measure,
        first=place.names[0],
        second="".join(place.names[1:]) or "other speech",
        # The smaller a rank, the better.
        truth=second - first if measure == "mean_rank" else first - second,
        found=found,
        decided=decided,
    )
