"""Kendall's W: how far rankings agree, video by video and overall."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.stats.rankings.friedman import Blocks, blocks_of_rankings, friedman
from analysis.stats.rankings.placements import Placements
from analysis.stats.two_way_bootstrap import percentile_interval, times_drawn

Floats = NDArray[np.float64]


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
class Concordance:
    """How far participants agree about one question, by Kendall's W.

    Attributes
    ----------
    estimate : float
        Mean over the segments that have one; NaN where none has.
    low, high : float
        Ends of its 95 % interval, participants and segments drawn again; NaN where there is none.
    overall : float
        Of the participants about the conditions, each ranked by the participant's mean ranks
        over segments (see `Friedman`).
    n : int
        Participants behind `overall`.
    segments : tuple of SegmentConcordance
        Of the participants about each segment.
    method, reason : str
        How the interval was found; why a number is missing.
    """

    estimate: float
    low: float = math.nan
    high: float = math.nan
    overall: float
    n: int
    segments: tuple[SegmentConcordance, ...]
    method: str = ""
    reason: str = ""


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
    known = [found.estimate for found in segments if not found.reason]
    overall = friedman(blocks_of_rankings(rankings))
    found = Concordance(
        estimate=float(np.mean(known)) if known else math.nan,
        overall=overall.kendall_w,
        n=overall.n,
        segments=segments,
        reason=overall.reason,
    )
    if len(known) < 2:
        few = "one segment gives no interval" if known else "no segment was ranked by two"
        return replace(found, reason=overall.reason or few)
    drawn = resampled_concordance(rankings, resamples=resamples, seed=seed)
    low, high = percentile_interval(drawn)
    return replace(
        found,
        low=low,
        high=high,
        method=f"bootstrap over participants and segments, {resamples} resamples",
    )


def _of_segment(rankings: Placements, number: int, name: str) -> SegmentConcordance:
    own = rankings.segments == number
    complete = own & rankings.complete
    test = friedman(Blocks(conditions=rankings.conditions, means=-rankings.ranks[complete]))
    return SegmentConcordance(
        segment=name,
        estimate=test.kendall_w,
        p_value=test.p_value,
        n=test.n,
        incomplete=int((own & ~complete).sum()),
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
    whole = rankings.complete
    who, what = rankings.participants[whole], rankings.segments[whole]
    centred = rankings.ranks[whole] - (len(rankings.conditions) + 1) / 2
    squares = (centred**2).sum(axis=1)
    people, things = len(rankings.participant_names), len(rankings.segment_names)
    order = np.argsort(what, kind="stable")
    bounds = np.searchsorted(what[order], np.arange(things + 1))
    own = [order[start:end] for start, end in pairwise(bounds)]
    found = []
    for start in range(0, resamples, BLOCK):
        size = min(BLOCK, resamples - start)
        by_person, by_segment = times_drawn(chance, size, people), times_drawn(chance, size, things)
        concordances = np.stack(
            [_concordance(by_person[:, who[rows]], centred[rows], squares[rows]) for rows in own],
            axis=1,
        )
        known = ~np.isnan(concordances) & (by_segment > 0)
        weights = np.where(known, by_segment, 0.0)
        with np.errstate(invalid="ignore"):
            found.append(
                (weights * np.where(known, concordances, 0.0)).sum(axis=1) / weights.sum(axis=1)
            )
    return np.concatenate(found)


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
