"""How far rankings agree, and tests of participants' mean ranks."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.results.place import PairPlace
from analysis.stats.rankings.friedman import blocks_of_rankings, friedman
from analysis.stats.rankings.kendall_w import kendall_w
from analysis.stats.rankings.placements import Placements
from analysis.stats.rankings.posthoc import PairwiseRanks, compare_pairs


@dataclass(frozen=True, kw_only=True)
class SegmentConcordance:
    """Kendall's W of the rankings of one segment; `incomplete` ones are left out."""

    segment: str
    w: float
    n: int
    incomplete: int
    reason: str


@dataclass(frozen=True, kw_only=True)
class Concordance:
    """How far participants agree.

    Attributes
    ----------
    mean, low, high : float
        Kendall's W, mean over segments that have one, and its 95 % interval: participants and
        segments drawn again.
    overall : float
        Kendall's W of participants' mean ranks over segments.
    n : int
        Participants behind `overall`.
    segments : tuple of SegmentConcordance
        One per segment.
    method : str
        How the interval was found.
    reason : str
        Why a number is missing.
    """

    mean: float
    low: float
    high: float
    overall: float
    n: int
    segments: tuple[SegmentConcordance, ...]
    method: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class Friedman:
    """Friedman's test over participants' mean ranks, with Iman and Davenport's F; secondary.

    It takes the segments as the only ones of interest.
    """

    statistic: float
    p: float
    n: int
    reason: str


@dataclass(frozen=True, kw_only=True)
class RankContrast(PairPlace):
    """Whether two conditions are placed otherwise, after Friedman's test; secondary.

    It rests on participants' mean ranks and takes the segments as the only ones of interest.

    Attributes
    ----------
    difference : float
        Mean rank of a minus that of b over participants, ranked by their means; below zero where
        a is the better one.
    nemenyi_p : float
        Of the Studentised range; corrects for all pairs of the question by itself.
    conover_p, conover_holm : float
        Of Conover and Iman's t; corrected over all pairs of the question.
    wilcoxon_p, wilcoxon_holm : float
        Exact, of participants' mean ranks; corrected likewise.
    n : int
        Participants who ranked all conditions.
    reason : str
        Why a number is missing.
    """

    difference: float
    nemenyi_p: float
    conover_p: float
    conover_holm: float
    wilcoxon_p: float
    wilcoxon_holm: float
    n: int
    reason: str


def concordance_of(given: Placements) -> Concordance:
    """Measure how far participants agree about one question."""
    found = kendall_w(given.averaged())
    return Concordance(
        mean=found.mean,
        low=found.low,
        high=found.high,
        overall=found.overall.estimate,
        n=found.overall.n,
        segments=tuple(
            SegmentConcordance(
                segment=one.segment,
                w=one.estimate,
                n=one.n,
                incomplete=one.incomplete,
                reason=one.reason,
            )
            for one in found.segments
        ),
        method=found.method,
        reason=found.overall.reason or found.reason,
    )


def posthoc_of(given: Placements, of: str | None, question: str) -> list[RankContrast]:
    """Compare every two conditions of one question of a set."""
    pairs = compare_pairs(blocks_of_rankings(given))
    return [_contrast(of, question, pair) for pair in pairs]


def _contrast(of: str | None, question: str, found: PairwiseRanks) -> RankContrast:
    return RankContrast(
        set=of,
        a=found.a,
        b=found.b,
        question=question,
        # Its ranks rise with how good a condition is; places fall.
        difference=-found.difference,
        nemenyi_p=found.nemenyi_p,
        conover_p=found.conover_p,
        conover_holm=found.conover_holm,
        wilcoxon_p=found.wilcoxon.p_value,
        wilcoxon_holm=found.wilcoxon_holm,
        n=found.n,
        reason=found.reason or found.wilcoxon.reason,
    )


def friedman_of(given: Placements) -> Friedman:
    """Test whether the conditions of one question differ."""
    found = friedman(blocks_of_rankings(given))
    return Friedman(statistic=found.statistic, p=found.p_value, n=found.n, reason=found.reason)
