"""Estimates beside values that are known: what an analysis finds of true values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

from analysis.results.grouping import PairPlace, Place
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
    return tuple(difference for report in reports for difference in _differences(report, truths))


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
                for one in (pair, pair.turned()):
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


def _differences(report: TableReport, truths: Mapping[_Key, float]) -> Iterator[KnownDifference]:
    parts = {key[1] for key in truths}

    def truth(measure: Measure, part: str | None, question: str, about: str) -> float:
        # A table without sets may be one part of a study that has several.
        for name in [part or ""] if report.sets else sorted(parts):
            if (measure, name, question, about) in truths:
                return truths[measure, name, question, about]
        return math.nan

    for difference in (*_from_half(report, truth), *_between(report, truth)):
        if not math.isnan(difference.truth):
            yield difference


_Truth = Callable[[Measure, str | None, str, str], float]


def _from_half(report: TableReport, truth: _Truth) -> Iterator[KnownDifference]:
    """Give the shares of a report, as differences from one half."""
    for measure, place, share in _estimates(report):
        if measure in ("win_share", "own_speech"):
            key = _key(measure, place)
            yield KnownDifference(
                part=key[1],
                question=place.question,
                measure=measure,
                first=place.names[0],
                second=place.names[1] if isinstance(place, PairPlace) else "other speech",
                truth=truth(measure, place.set, place.question, key[-1]) - 0.5,
                found=replace(
                    share, estimate=share.estimate - 0.5, low=share.low - 0.5, high=share.high - 0.5
                ),
                decided=share.has_interval and not share.covers(0.5),
            )


def _between(report: TableReport, truth: _Truth) -> Iterator[KnownDifference]:
    """Give the differences between every two conditions that were rated or ranked."""
    pairs: list[tuple[Measure, PairPlace, Estimate, bool]] = []
    match report.results:
        case RatingResults(contrasts=contrasts):
            for one in contrasts:
                found: Estimate = one.difference
                decided = found.has_interval and not found.covers(0.0)
                pairs.append(("mean_rating", one, found, decided))
        case RankingResults(posthoc=posthoc):
            for ranks in posthoc:
                found = Estimate(
                    estimate=-ranks.difference,
                    participants=ranks.n,
                    reason=ranks.reason or NO_RANK_INTERVAL,
                )
                pairs.append(("mean_rank", ranks, found, ranks.conover_holm < SIGNIFICANT))
    for measure, pair, found, decided in pairs:
        values = [truth(measure, pair.set, pair.question, name) for name in pair.names]
        # The smaller a rank, the better.
        sign = -1 if measure == "mean_rank" else 1
        yield KnownDifference(
            part=pair.set or "",
            question=pair.question,
            measure=measure,
            first=pair.a,
            second=pair.b,
            truth=sign * (values[0] - values[1]),
            found=found,
            decided=decided,
        )
