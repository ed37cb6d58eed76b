"""Friedman's test, the tests pair by pair after it, and Kendall's W: how far rankings agree.

Blocks are participants, each with one number per condition: their mean over segments. Pairs of
participant and segment cannot be blocks: single answers are not independent, and a test over them
finds differences that are not there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.clustered_mean import Interval
from analysis.stats.multiple_testing import holm
from analysis.stats.placements import Blocks, Placements, blocks_of_rankings
from analysis.stats.samples import bootstrap_counts, percentile_interval
from analysis.stats.signed_rank import signed_rank

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Friedman:
    """Whether the conditions differ.

    Attributes
    ----------
    mean_ranks : dict of str to float
        Mean rank of each condition, the larger the better; NaN without participants.
    statistic, df, p_value : float
        Friedman's chi-square, corrected for ties.
    kendall_w : float
        Concordance: 0 for none, 1 where all participants rank alike.
    n, incomplete : int
        Participants it rests on, and those left out.
    reason : str
        Why there is no test; empty where there is one.
    """

    mean_ranks: dict[str, float]
    statistic: float = math.nan
    df: int
    p_value: float = math.nan
    kendall_w: float = math.nan
    n: int
    incomplete: int
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class PairwiseRanks:
    """How two conditions differ over participants.

    Attributes
    ----------
    a, b : str
        The conditions.
    difference : float
        Mean place of a minus that of b over participants, ranked by their means: below zero
        where a is the better one; NaN without a test.
    nemenyi_p : float
        Of the Studentised range; corrects for all pairs by itself.
    conover_p, conover_holm : float
        Of Conover & Iman's t, plain and after Holm's correction.
    wilcoxon_p, wilcoxon_holm : float
        Of the participants' differences, exact.
    n : int
        Participants.
    reason : str
        Why a number is missing; empty where none is.
    """

    a: str
    b: str
    difference: float = math.nan
    nemenyi_p: float = math.nan
    conover_p: float = math.nan
    conover_holm: float = math.nan
    wilcoxon_p: float
    wilcoxon_holm: float = math.nan
    n: int
    reason: str = ""


def friedman(blocks: Blocks) -> Friedman:
    """Test whether any condition is placed differently from the others (Friedman 1937)."""
    count, width = blocks.means.shape
    mean_ranks = blocks.ranks.mean(axis=0) if count else np.full(width, math.nan)
    unknown = Friedman(
        mean_ranks=dict(zip(blocks.conditions, mean_ranks.tolist(), strict=True)),
        df=max(width - 1, 0),
        n=count,
        incomplete=blocks.incomplete,
    )
    within = float(((blocks.ranks - (width + 1) / 2) ** 2).sum())
    if reason := _why_not(count, width, within):
        return replace(unknown, reason=reason)
    between = count * float(((mean_ranks - (width + 1) / 2) ** 2).sum())
    concordance = min(1.0, between / within)
    statistic = count * unknown.df * concordance
    return replace(
        unknown,
        statistic=statistic,
        p_value=float(stats.chi2.sf(statistic, unknown.df)),
        kendall_w=concordance,
    )


def _why_not(participants: int, conditions: int, within: float) -> str:
    if conditions < 2:
        return "fewer than two conditions"
    if participants < 2:
        return "fewer than two participants with all conditions"
    return "" if within else "nobody tells conditions apart"


def compare_pairs(blocks: Blocks) -> tuple[PairwiseRanks, ...]:
    """Compare every two conditions (Nemenyi 1963; Conover 1999; Wilcoxon 1945).

    Holm's corrections are over all pairs returned.
    """
    whole = friedman(blocks)
    pairs = [
        _pair(blocks, a, b, whole.reason) for a, b in combinations(range(len(blocks.conditions)), 2)
    ]
    corrected = holm([pair.conover_p for pair in pairs]), holm([pair.wilcoxon_p for pair in pairs])
    return tuple(
        replace(pair, conover_holm=conover, wilcoxon_holm=wilcoxon)
        for pair, conover, wilcoxon in zip(pairs, *corrected, strict=True)
    )


def _pair(blocks: Blocks, a: int, b: int, reason: str) -> PairwiseRanks:
    count, width = blocks.means.shape
    ranks = signed_rank(blocks.means[:, a] - blocks.means[:, b])
    comparison = PairwiseRanks(
        a=blocks.conditions[a],
        b=blocks.conditions[b],
        wilcoxon_p=ranks.p_value,
        n=count,
        reason=reason or ranks.reason,
    )
    if reason:
        return comparison
    means = blocks.ranks.mean(axis=0)
    difference = float(means[b] - means[a])
    studentized = abs(difference) / math.sqrt(width * (width + 1) / (12 * count))
    # What is left of the ranks' variance within participants once conditions are taken out.
    residual = float((blocks.ranks**2).sum()) - count * float((means**2).sum())
    freedom = (count - 1) * (width - 1)
    error = math.sqrt(2 * max(residual, 0.0) / (count * freedom))
    if error > 1e-9:
        conover = float(2 * stats.t.sf(abs(difference) / error, freedom))
    else:
        conover = 1.0 if difference == 0 else 0.0
    return replace(
        comparison,
        difference=difference,
        nemenyi_p=float(np.clip(stats.studentized_range.sf(studentized, width, np.inf), 0, 1)),
        conover_p=conover,
    )


RESAMPLES: Final = 2000
BLOCK: Final = 200
"""Resamples drawn at a time: bounds the memory."""


@dataclass(frozen=True, kw_only=True)
class SegmentConcordance:
    """Kendall's W of the rankings of one segment.

    Attributes
    ----------
    segment : str
        Which one.
    estimate : float
        Kendall's W with ties, from 0 to 1; NaN where there is none.
    p_value : float
        Of W being no more than chance gives, by chi-square; rough for few rankings.
    n, incomplete : int
        Rankings it rests on, and those left out because they do not place every condition.
    reason : str
        Why there is no number; empty where there is one.
    """

    segment: str
    estimate: float
    p_value: float
    n: int
    incomplete: int
    reason: str


@dataclass(frozen=True, kw_only=True)
class Concordance(Interval):
    """How far participants agree about one question, by Kendall's W.

    The estimate is the mean over the segments that have one; its interval draws participants and
    segments again.

    Attributes
    ----------
    overall : float
        Of the participants about the conditions, each ranked by the participant's mean ranks
        over segments (see `Friedman`).
    n : int
        Participants behind `overall`.
    segments : tuple of SegmentConcordance
        Of the participants about each segment.
    method : str
        How the interval was found.
    """

    overall: float
    n: int
    segments: tuple[SegmentConcordance, ...]
    method: str = ""


def kendall_w(rankings: Placements, *, resamples: int = RESAMPLES, seed: int = 0) -> Concordance:
    """Measure how far participants agree (Kendall & Babington Smith 1939, corrected for ties).

    Parameters
    ----------
    rankings : Placements
        Of one question.
    resamples, seed : int
        Bootstrap resamples of participants and segments, and what draws them.
    """
    segments = tuple(
        _of_segment(rankings, number, name) for number, name in enumerate(rankings.segment_names)
    )
    known = [concordance.estimate for concordance in segments if not concordance.reason]
    overall = friedman(blocks_of_rankings(rankings))
    concordance = Concordance(
        estimate=float(np.mean(known)) if known else math.nan,
        overall=overall.kendall_w,
        n=overall.n,
        segments=segments,
        reason=overall.reason,
    )
    if len(known) < 2:
        few = "one segment gives no interval" if known else "no segment was ranked by two"
        return replace(concordance, reason=overall.reason or few)
    drawn = resampled_concordance(rankings, resamples=resamples, seed=seed)
    low, high = percentile_interval(drawn)
    return replace(
        concordance,
        low=low,
        high=high,
        method=f"bootstrap over participants and segments, {resamples} resamples",
    )


def _of_segment(rankings: Placements, number: int, name: str) -> SegmentConcordance:
    rows = rankings.segments == number
    complete = rows & rankings.complete
    test = friedman(Blocks(conditions=rankings.conditions, means=-rankings.ranks[complete]))
    return SegmentConcordance(
        segment=name,
        estimate=test.kendall_w,
        p_value=test.p_value,
        n=test.n,
        incomplete=int((rows & ~complete).sum()),
        reason=test.reason,
    )


def resampled_concordance(
    rankings: Placements, *, resamples: int = RESAMPLES, seed: int = 0
) -> Floats:
    """Return the mean W over segments of resampled studies, shape (resamples,).

    A participant drawn twice agrees with themselves, which would raise W. So only pairs of
    different participants count: with their mean correlation r, W of n rankings is
    (1 + (n - 1) r) / n.

    Parameters
    ----------
    rankings : Placements
        Of one question; rankings that leave conditions out do not count.
    resamples, seed : int
        How many to draw, and what draws them.

    Returns
    -------
    ndarray, shape (resamples,)
        NaN where no segment drawn has two different participants who tell conditions apart.
    """
    chance = np.random.default_rng(seed)
    complete = rankings.complete
    participants, segments = rankings.participants[complete], rankings.segments[complete]
    centred = rankings.ranks[complete] - (len(rankings.conditions) + 1) / 2
    squares = (centred**2).sum(axis=1)
    participant_count, segment_count = len(rankings.participant_names), len(rankings.segment_names)
    of_segment = [np.flatnonzero(segments == segment) for segment in range(segment_count)]
    means = []
    for start in range(0, resamples, BLOCK):
        size = min(BLOCK, resamples - start)
        by_participant = bootstrap_counts(chance, size, participant_count)
        by_segment = bootstrap_counts(chance, size, segment_count)
        concordances = np.stack(
            [
                _concordance(by_participant[:, participants[rows]], centred[rows], squares[rows])
                for rows in of_segment
            ],
            axis=1,
        )
        known = ~np.isnan(concordances) & (by_segment > 0)
        weights = np.where(known, by_segment, 0.0)
        with np.errstate(invalid="ignore"):
            means.append(
                (weights * np.where(known, concordances, 0.0)).sum(axis=1) / weights.sum(axis=1)
            )
    return np.concatenate(means)


def _concordance(times: Floats, centred: Floats, squares: Floats) -> Floats:
    """Return W of one segment's rankings, each counted `times`, shape (resamples, rankings)."""
    count = len(centred)
    sums = times @ centred
    pairs = (sums**2).sum(axis=1) - times**2 @ squares
    total = times.sum(axis=1)
    different = total**2 - (times**2).sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = pairs / different / (times @ squares / total)
    correlation[different <= 0] = np.nan
    return np.asarray((1 + (count - 1) * correlation) / max(count, 1), np.float64)
