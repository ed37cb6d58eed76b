"""Where each condition is placed: Figure 7 of DiffSHEG, and mean rank and first-place share."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from analysis.stats.clustered_mean import ClusteredMean, clustered_mean
from analysis.stats.rankings.placements import Placements


@dataclass(frozen=True, kw_only=True)
class RankSummary:
    """Where one condition is placed.

    Attributes
    ----------
    condition : str
        Its name.
    mean_rank : ClusteredMean
        Mean rank, 1 is best, tied conditions sharing the mean of their places; tested against
        the middle rank.
    first_share : ClusteredMean
        Share of the rankings in which it is best, conditions tied for it sharing one ranking;
        tested against what chance would give each.
    rank_percent : tuple of float
        Share of each place, in percent, ties spread evenly over their places; NaN without any.
    rankings : int
        How many place it.
    remark : str
        What limits the numbers; empty where nothing does.
    """

    condition: str
    mean_rank: ClusteredMean
    first_share: ClusteredMean
    rank_percent: tuple[float, ...]
    rankings: int
    remark: str = ""


def rank_summaries(rankings: Placements) -> tuple[RankSummary, ...]:
    """Summarise the rankings of one question, one row per condition.

    Intervals are clustered by participant and segment as those of a win share.
    """
    return tuple(
        _summary(rankings, column, condition)
        for column, condition in enumerate(rankings.conditions)
    )


def _summary(rankings: Placements, column: int, condition: str) -> RankSummary:
    places = len(rankings.conditions)
    there = ~np.isnan(rankings.given[:, column])
    better, tied = rankings.better[there, column], rankings.tied[there, column]
    who, what = rankings.participants[there], rankings.segments[there]
    place = np.arange(1, places + 1)
    held = ((better[:, None] < place) & (place <= (better + tied)[:, None])) / tied[:, None]
    count = int(there.sum())
    partial = int((there & ~rankings.complete).sum())
    return RankSummary(
        condition=condition,
        mean_rank=clustered_mean(
            rankings.ranks[there, column], who, what, null=(places + 1) / 2, limits=(1, places)
        ),
        first_share=clustered_mean(held[:, 0], who, what, null=1 / places),
        rank_percent=tuple((100 * held.mean(axis=0)).tolist()) if count else (math.nan,) * places,
        rankings=count,
        remark=f"{partial} of {count} rankings leave conditions out" if partial else "",
    )
