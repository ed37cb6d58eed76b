"""Agreement of participants, with one another (alpha, Kendall's W) and with themselves (kappa).

Krippendorff's alpha is 1 if all participants agree, and 0 if they agree as much as by chance. A
real effect can occur with an alpha near zero: if all slightly prefer one condition, each in
different items, they agree about the condition but not about the items.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.clustered_mean import Interval
from analysis.stats.rankings import Blocks, Placements, blocks_of_rankings, friedman
from analysis.stats.samples import bootstrap_counts, percentile_interval
from motion.arrays import Floats, Ints

RESAMPLES: Final = 2000
BLOCK: Final = 200
"""Resamples drawn at a time, a divisor of `RESAMPLES`; bounds the memory."""


@dataclass(frozen=True, kw_only=True)
class Alpha(Interval):
    """Krippendorff's alpha, at most 1, with its interval over items.

    Attributes
    ----------
    n, items, participants : int
        Numbers of answers, items and participants; only items with at least two participants count.
    method : str
        How the interval was computed; empty if there is none.
    """

    n: int
    items: int
    participants: int
    method: str = ""


def krippendorff_alpha(
    values: NDArray[np.number], raters: NDArray[np.generic], items: NDArray[np.generic]
) -> Alpha:
    """Estimate alpha from ordered answers, of which some may be missing (Krippendorff 2011).

    Parameters
    ----------
    values : ndarray, shape (N,)
        Answers as numbers in their order.
    raters, items : ndarray, shape (N,)
        The rater and the item of each answer; at most one answer for each pair.
    """
    table = pd.DataFrame({"value": np.asarray(values, np.float64), "rater": raters, "item": items})
    table = table[table.groupby("item")["rater"].transform("size") > 1]
    domain, codes = np.unique(table["value"].to_numpy(), return_inverse=True)
    rows = pd.factorize(table["item"])[0]
    count = int(rows.max(initial=-1)) + 1
    unknown = Alpha(n=len(table), items=count, participants=int(table["rater"].nunique()))
    if not count:
        return replace(unknown, reason="no item was answered about by two participants")
    if len(domain) < 2:
        return replace(unknown, reason="all answers alike")
    cells = np.bincount(rows * len(domain) + codes, minlength=count * len(domain))
    coincidences = _coincidences(cells.reshape(count, len(domain)).astype(np.float64))
    [estimate] = _alphas(coincidences.sum(axis=0)[None])
    alpha = replace(unknown, estimate=float(estimate))
    if count < 2:
        return replace(alpha, reason="one item gives no interval")
    drawn = [_alphas(tables) for tables in _drawn_tables(coincidences)]
    low, high = percentile_interval(np.concatenate(drawn))
    return replace(alpha, low=low, high=high, method=f"bootstrap over items, {RESAMPLES} resamples")


def _coincidences(counts: Floats) -> Floats:
    """Return each item's pairs of values, (items, values, values), from its counts of values."""
    pairs = counts[:, :, None] * counts[:, None, :]
    places = np.arange(counts.shape[1])
    pairs[:, places, places] -= counts
    return np.asarray(pairs / (counts.sum(axis=1) - 1)[:, None, None], np.float64)


def _alphas(coincidences: Floats) -> Floats:
    """Return alpha of each table of coincidences, (tables, values, values); NaN for one value.

    The distance of two ordinal values is the number of answers between them.
    """
    totals = coincidences.sum(axis=2)
    count = totals.sum(axis=1)
    middles = np.cumsum(totals, axis=1) - totals / 2
    squared_distances = (middles[:, :, None] - middles[:, None, :]) ** 2
    observed = np.einsum("tij,tij->t", coincidences, squared_distances)
    expected = np.einsum("ti,tj,tij->t", totals, totals, squared_distances) / (count - 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(expected > 0, 1 - observed / expected, math.nan)


@dataclass(frozen=True, kw_only=True)
class Retest(Interval):
    """Agreement of participants with themselves.

    The estimate is Cohen's kappa with quadratic weights: 1 for identical answers, 0 for chance
    agreement. Its interval resamples participants.

    Attributes
    ----------
    equal_share : float
        Share of the pairs with the same answer; NaN without any.
    spearman : float
        Rank correlation; NaN if one side's answers are all alike.
    n, participants : int
        Number of trials answered twice, and of their participants.
    method : str
        How the interval was computed; empty if there is none.
    """

    equal_share: float = math.nan
    spearman: float = math.nan
    n: int
    participants: int
    method: str = ""


def retest_agreement(
    first: NDArray[np.integer],
    repeat: NDArray[np.integer],
    participants: NDArray[np.generic],
) -> Retest:
    """Compare the answers to trials with those to their repeats (Cohen 1968).

    Parameters
    ----------
    first, repeat : ndarray of int, shape (N,)
        Answers as equally spaced numbers.
    participants : ndarray, shape (N,)
        The participant of each pair of answers.
    """
    first_values, repeat_values = np.asarray(first, np.int64), np.asarray(repeat, np.int64)
    person = np.unique(participants, return_inverse=True)[1]
    count = int(person.max(initial=-1)) + 1
    unknown = Retest(n=len(first_values), participants=count)
    if not len(first_values):
        return replace(unknown, reason="no trial was answered again")
    lowest = int(min(first_values.min(), repeat_values.min()))
    scores = int(max(first_values.max(), repeat_values.max())) - lowest + 1
    cells = (person * scores + first_values - lowest) * scores + repeat_values - lowest
    tables = np.bincount(cells, minlength=count * scores**2).astype(np.float64)
    tables = tables.reshape(count, scores, scores)
    [kappa] = _kappas(tables.sum(axis=0)[None])
    retest = replace(
        unknown,
        estimate=float(kappa),
        spearman=_spearman(first_values, repeat_values),
        equal_share=float((first_values == repeat_values).mean()),
    )
    if count < 2:
        return replace(retest, reason="one participant gives no interval")
    if math.isnan(retest.estimate):
        return replace(retest, reason="all answers alike")
    drawn = [_kappas(resampled) for resampled in _drawn_tables(tables)]
    low, high = percentile_interval(np.concatenate(drawn))
    reason = "one side's answers are all alike" if math.isnan(retest.spearman) else ""
    method = f"bootstrap over participants, {RESAMPLES} resamples"
    return replace(retest, low=low, high=high, method=method, reason=reason)


def _kappas(tables: Floats) -> Floats:
    """Return weighted kappa of each table of first by second answers; NaN for a single answer."""
    score = np.arange(tables.shape[1])
    weights = ((score[:, None] - score) ** 2).astype(np.float64)
    count = tables.sum(axis=(1, 2))
    observed = np.einsum("tij,ij->t", tables, weights)
    before, after = tables.sum(axis=2), tables.sum(axis=1)
    expected = np.einsum("ti,tj,ij->t", before, after, weights) / count
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(expected > 0, 1 - observed / expected, math.nan)


def _spearman(first: Ints, repeat: Ints) -> float:
    if not (np.ptp(first) and np.ptp(repeat)):
        return math.nan
    return float(stats.spearmanr(first, repeat).statistic)


def _drawn_tables(tables: Floats) -> Iterator[Floats]:
    """Yield the summed tables of resampled items or participants, shape (resamples, k, k)."""
    chance = np.random.default_rng(0)
    count, size, _ = tables.shape
    flat = tables.reshape(count, -1)
    for _ in range(RESAMPLES // BLOCK):
        times = chance.multinomial(count, np.full(count, 1 / count), size=BLOCK)
        yield (times @ flat).reshape(BLOCK, size, size)


@dataclass(frozen=True, kw_only=True)
class SegmentConcordance:
    """Kendall's W of the rankings of one segment.

    Attributes
    ----------
    segment : str
        The segment's name.
    estimate : float
        Kendall's W with ties, from 0 to 1; NaN if there is none.
    p_value : float
        p-value of W if all orders were random, by chi-square; approximate for few rankings.
    n, incomplete : int
        Number of rankings used, and of those left out because they do not place every condition.
    reason : str
        Why there is no W; empty if there is one.
    """

    segment: str
    estimate: float
    p_value: float
    n: int
    incomplete: int
    reason: str


@dataclass(frozen=True, kw_only=True)
class Concordance(Interval):
    """Agreement of participants on one question, by Kendall's W.

    The estimate is the mean over the segments that have a W; its interval resamples participants
    and segments.

    Attributes
    ----------
    overall : float
        Kendall's W of the participants' own mean ranks over segments, ranked again (see
        `Friedman`).
    n : int
        Number of participants behind `overall`.
    segments : tuple of SegmentConcordance
        Concordance of the participants about each segment.
    method : str
        How the interval was computed.
    """

    overall: float
    n: int
    segments: tuple[SegmentConcordance, ...]
    method: str = ""


def kendall_w(rankings: Placements) -> Concordance:
    """Measure participants' agreement (Kendall & Babington Smith 1939, corrected for ties).

    Parameters
    ----------
    rankings : Placements
        Rankings of one question.
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
    drawn = resampled_concordance(rankings)
    # With few participants the correction may lead below zero, where W cannot be.
    low, high = percentile_interval(np.clip(drawn, 0.0, 1.0))
    return replace(
        concordance,
        low=low,
        high=high,
        method=f"bootstrap over participants and segments, {RESAMPLES} resamples",
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


def resampled_concordance(rankings: Placements) -> Floats:
    """Return the mean W over segments of resampled studies, shape (RESAMPLES,).

    A participant drawn twice agrees with themselves, which would raise W. So only pairs of
    different participants count: if their mean correlation is r, W of n rankings is (1 + (n - 1) r)
    / n.

    Parameters
    ----------
    rankings : Placements
        Rankings of one question; rankings that omit conditions do not count.

    Returns
    -------
    ndarray, shape (RESAMPLES,)
        NaN if no segment drawn has two different participants who distinguish conditions.
    """
    chance = np.random.default_rng(0)
    complete = rankings.complete
    participants, segments = rankings.participants[complete], rankings.segments[complete]
    centred = rankings.ranks[complete] - (len(rankings.conditions) + 1) / 2
    squares = (centred**2).sum(axis=1)
    participant_count, segment_count = len(rankings.participant_names), len(rankings.segment_names)
    of_segment = [np.flatnonzero(segments == segment) for segment in range(segment_count)]
    means = []
    for _ in range(RESAMPLES // BLOCK):
        by_participant = bootstrap_counts(chance, BLOCK, participant_count)
        by_segment = bootstrap_counts(chance, BLOCK, segment_count)
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
