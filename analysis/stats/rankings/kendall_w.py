"""Kendall's W: how far rankings agree, video by video and overall."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from analysis.stats.rankings.friedman import Blocks, blocks_of_rankings, friedman
from analysis.stats.rankings.placements import Placements
from analysis.stats.rankings.resampled_concordance import RESAMPLES, resampled_concordance
from analysis.stats.two_way_bootstrap import percentile_interval


@dataclass(frozen=True, kw_only=True)
class Concordance:
    """How far several rankings of the same conditions agree.

    Attributes
    ----------
    segment : str
        The segment ranked; empty for all of them.
    estimate : float
        Kendall's W with ties, from 0 to 1; NaN where there is none.
    mean_correlation : float
        Mean Spearman correlation of any two of the rankings: (W n - 1) / (n - 1).
    statistic, freedom, p_value : float
        Chi-square of W being no more than chance gives; rough for few rankings.
    n, incomplete : int
        Rankings it rests on, and those left out because they do not place every condition.
    reason : str
        Why there is no number; empty where there is one.
    """

    segment: str
    estimate: float
    mean_correlation: float
    statistic: float
    freedom: int
    p_value: float
    n: int
    incomplete: int
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class KendallW:
    """Agreement about one question.

    Attributes
    ----------
    segments : tuple of Concordance
        Of the participants about each segment.
    mean : float
        Mean over the segments that have one; NaN where none has.
    low, high : float
        Ends of its 95 % interval, participants and segments drawn again; NaN where there is none.
    method, reason : str
        How the interval was found; why there is none.
    overall : Concordance
        Of the participants about the conditions, each ranked by the participant's mean ranks
        over segments. Its p value treats the segments as the only ones of interest.
    """

    segments: tuple[Concordance, ...]
    mean: float
    overall: Concordance
    low: float = math.nan
    high: float = math.nan
    method: str = ""
    reason: str = ""


def kendall_w(rankings: Placements, *, resamples: int = RESAMPLES, seed: int = 0) -> KendallW:
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
    known = [found.estimate for found in segments if not found.reason]
    found = KendallW(
        segments=segments,
        mean=float(np.mean(known)) if known else math.nan,
        overall=_concordance("", blocks_of_rankings(rankings)),
    )
    if len(known) < 2:
        few = "one segment gives no interval" if known else "no segment was ranked by two"
        return replace(found, reason=few)
    drawn = resampled_concordance(rankings, resamples=resamples, seed=seed)
    low, high = percentile_interval(drawn)
    return replace(
        found,
        low=low,
        high=high,
        method=f"bootstrap over participants and segments, {resamples} resamples",
    )


def _of_segment(rankings: Placements, number: int, name: str) -> Concordance:
    own = rankings.segments == number
    complete = own & rankings.complete
    return _concordance(
        name,
        Blocks(
            conditions=rankings.conditions,
            means=-rankings.ranks[complete],
            incomplete=int((own & ~complete).sum()),
        ),
    )


def _concordance(segment: str, blocks: Blocks) -> Concordance:
    test = friedman(blocks)
    found = Concordance(
        segment=segment,
        estimate=test.kendall_w,
        mean_correlation=math.nan,
        statistic=test.statistic,
        freedom=test.freedom,
        p_value=test.p_value,
        n=test.n,
        incomplete=test.incomplete,
        reason=test.reason,
    )
    if test.reason:
        return found
    return replace(found, mean_correlation=(test.kendall_w * test.n - 1) / (test.n - 1))
