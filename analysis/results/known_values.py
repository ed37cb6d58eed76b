"""Estimates of a report compared with the true values of a simulation."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

from analysis.results.conditions import RankingResults, RatingResults
from analysis.results.grouping import ResultKey
from analysis.results.headline import MEASURES, Measure
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.report import Results, TableReport
from analysis.stats.clustered_mean import LEVEL, Estimate

Sign = Literal["right", "wrong", "undecided", "equal"]

SIGNIFICANT: Final = 1 - LEVEL
"""A smaller p decides which of two ranked conditions is better."""

NO_RANK_INTERVAL: Final = "the test compares worths, not mean ranks"
"""Why the difference of two mean ranks has no interval."""


@dataclass(frozen=True, kw_only=True)
class KnownValue:
    """A true value of simulated raters' preferences.

    Attributes
    ----------
    about : str
        The comparison (``first-second``) or the condition.
    part : str
        The set, block or task; empty if the study has none.
    question : str
        Name of the question.
    measure : {'win_share', 'own_speech', 'mean_rating', 'mean_rank'}
        Wins plus half the ties of the first condition of a comparison, in [0, 1]; the same of a
        motion with its own speech against itself with another, in [0, 1]; the mean rating, on the
        question's scale; the mean rank, 1 the best.
    value : float
        The value over all raters and all segments like these, which an interval should cover.
    on_these_segments : float
        The value over all raters for the study's own segments, whose draw the estimate shares.
    """

    about: str
    part: str = ""
    question: str
    measure: Measure
    value: float
    on_these_segments: float


@dataclass(frozen=True, kw_only=True)
class KnownDifference:
    """Which of two sides is better, by the true values and by the analysis.

    Attributes
    ----------
    part, question : str
        As in `KnownValue`.
    measure : str
        'win_share', 'own_speech', or a difference: 'mean_rating' or 'mean_rank'.
    first, second : str
        The conditions; of 'own_speech', the condition with its own speech, and ``other speech``.
    truth : float
        How much better the first is, below zero if it is worse: for shares the distance from one
        half, for ranks how much further in front.
    estimate : Estimate
        The difference found by the analysis.
    decided : bool
        Whether the analysis finds a difference.
    """

    part: str
    question: str
    measure: Measure
    first: str
    second: str
    truth: float
    estimate: Estimate
    decided: bool

    @property
    def sign(self) -> Sign:
        """Whether the analysis finds the better side.

        'equal' if there is no true difference and none is found.
        """
        if not self.decided:
            return "equal" if self.truth == 0 else "undecided"
        return "right" if self.estimate.estimate * self.truth > 0 else "wrong"

    @property
    def half_width(self) -> float:
        """Half the width of the interval; NaN without one."""
        return (self.estimate.high - self.estimate.low) / 2


def match_values(
    reports: Sequence[TableReport], known: Sequence[KnownValue]
) -> tuple[tuple[KnownValue, Estimate], ...]:
    """Return each known value that was estimated, with its estimate."""
    pairs = []
    for report in reports:
        estimates = {_key(key): estimate for key, estimate in _estimates(report.results)}
        for value in known:
            key = value.part if report.sets else "", value.question, value.about
            if value.measure == MEASURES[report.protocol] and key in estimates:
                pairs.append((value, estimates[key]))
    return tuple(pairs)


def match_differences(
    reports: Sequence[TableReport], known: Sequence[KnownValue]
) -> tuple[KnownDifference, ...]:
    """Return, for each pair compared, whether the better side is found."""
    differences = []
    for report in reports:
        measure = MEASURES[report.protocol]
        truths = {(v.part, v.question, v.about): v.value for v in known if v.measure == measure}
        is_share = measure in ("win_share", "own_speech")
        for key, estimate, decided in _compared(report.results):
            part, question, pair = _key(key)
            # A table without sets may be one part of a study that has several.
            parts = [part] if report.sets else sorted({part for part, _, _ in truths})
            values = [
                next((truths[k] for p in parts if (k := (p, question, about)) in truths), math.nan)
                for about in ((pair,) if is_share else key.names)
            ]
            first, second = [*values, 0.5][:2]
            difference = KnownDifference(
                part=part,
                question=question,
                measure=measure,
                first=key.names[0],
                second="".join(key.names[1:]) or "other speech",
                # The smaller a rank, the better.
                truth=second - first if measure == "mean_rank" else first - second,
                estimate=estimate,
                decided=decided,
            )
            if not math.isnan(difference.truth):
                differences.append(difference)
    return tuple(differences)


def _key(key: ResultKey) -> tuple[str, str, str]:
    """Return part, question and subject."""
    return key.set or "", key.question, "-".join(key.names)


def _estimates(results: Results) -> Iterator[tuple[ResultKey, Estimate]]:
    """Yield every headline number of a report, both ways round for pairs."""
    match results:
        case PairwiseResults():
            for comparison in results.comparisons:
                for either in (comparison, comparison.mirrored()):
                    yield either, either.win_share
        case MismatchResults():
            yield from ((condition, condition.win_share) for condition in results.conditions)
        case RatingResults():
            yield from ((condition, condition) for condition in results.conditions)
        case RankingResults():
            yield from ((condition, condition.mean_rank) for condition in results.conditions)


def _compared(results: Results) -> Iterator[tuple[ResultKey, Estimate, bool]]:
    """Yield each difference (of a share, from one half), and whether it is significant."""
    match results:
        case RatingResults(contrasts=contrasts):
            for contrast in contrasts:
                difference = contrast.difference
                decided = difference.has_interval and not difference.covers(0.0)
                yield contrast, difference, decided
        case RankingResults(conditions=ranked, contrasts=worths):
            ranks = {(each.set, each.question, each.condition): each.mean_rank for each in ranked}
            for pair in worths:
                first, second = (ranks[pair.set, pair.question, name] for name in pair.names)
                ahead = Estimate(
                    estimate=second.estimate - first.estimate,
                    participants=first.participants,
                    reason=pair.reason or NO_RANK_INTERVAL,
                )
                # Outside the report's family p is not corrected.
                p = pair.p_value if math.isnan(pair.p_holm) else pair.p_holm
                yield pair, ahead, p < SIGNIFICANT
        case _:
            for key, share in _estimates(results):
                moved = {name: getattr(share, name) - 0.5 for name in ("estimate", "low", "high")}
                decided = share.has_interval and not share.covers(0.5)
                yield key, replace(share, **moved), decided
