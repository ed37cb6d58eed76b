"""How far participants agree: with one another (Krippendorff's alpha), and with themselves (kappa).

Alpha is 1 where all participants agree, 0 where they agree as far as chance would make them. A
real effect may come with an alpha near zero: that all prefer one condition slightly, each in other
items, is agreement about the condition and not about the items.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.clustered_mean import Interval
from analysis.stats.samples import finite, percentile_interval
from motion.errors import InputError

Floats = NDArray[np.float64]

RESAMPLES: Final = 2000
BLOCK: Final = 200
"""Resamples drawn at a time: bounds the memory."""


@dataclass(frozen=True, kw_only=True)
class Alpha(Interval):
    """Krippendorff's alpha, at most 1, with its interval over items.

    Attributes
    ----------
    n, items, participants : int
        What it rests on: answers about items that at least two participants answered about.
    method : str
        How the interval was found; empty where there is none.
    """

    n: int
    items: int
    participants: int
    method: str = ""


def krippendorff_alpha(
    values: NDArray[np.number],
    raters: NDArray[np.generic],
    items: NDArray[np.generic],
    *,
    resamples: int = RESAMPLES,
    seed: int = 0,
) -> Alpha:
    """Estimate alpha from ordered answers, of which some may be missing (Krippendorff 2011).

    Parameters
    ----------
    values : ndarray, shape (N,)
        Answers as numbers in their order.
    raters, items : ndarray, shape (N,)
        Who answered about what; one answer of each about each.
    resamples, seed : int
        Bootstrap resamples of the items, and what draws them.

    Raises
    ------
    InputError
        If somebody answered twice about an item.
    """
    table = pd.DataFrame({"value": finite(values), "rater": raters, "item": items})
    if table.duplicated(["rater", "item"]).any():
        raise InputError(
            "a participant answered twice about an item",
            remedy="Measure agreement for one question and one comparison at a time",
        )
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
    drawn = [_alphas(tables) for tables in _drawn_tables(coincidences, resamples, seed)]
    low, high = percentile_interval(np.concatenate(drawn))
    return replace(alpha, low=low, high=high, method=f"bootstrap over items, {resamples} resamples")


def _coincidences(counts: Floats) -> Floats:
    """Return each item's pairs of values, (items, values, values), from its counts of values."""
    pairs = counts[:, :, None] * counts[:, None, :]
    places = np.arange(counts.shape[1])
    pairs[:, places, places] -= counts
    return np.asarray(pairs / (counts.sum(axis=1) - 1)[:, None, None], np.float64)


def _alphas(coincidences: Floats) -> Floats:
    """Return alpha of each table of coincidences, (tables, values, values); NaN for one value.

    Two ordinal values are as far apart as there are answers between them.
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
    """How far participants agree with themselves.

    The estimate is Cohen's weighted kappa, quadratic weights: 1 for the same answers, 0 for as much
    agreement as chance gives; its interval draws participants again.

    Attributes
    ----------
    equal_share : float
        Share of the pairs with the same answer; NaN without any.
    spearman : float
        Rank correlation; NaN where one side's answers are all alike.
    n, participants : int
        Trials answered twice, and by how many.
    method : str
        How the interval was found; empty where there is none.
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
        Who gave them.
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
    drawn = [_kappas(resampled) for resampled in _drawn_tables(tables, RESAMPLES, 0)]
    low, high = percentile_interval(np.concatenate(drawn))
    reason = "one side's answers are all alike" if math.isnan(retest.spearman) else ""
    method = f"bootstrap over participants, {RESAMPLES} resamples"
    return replace(retest, low=low, high=high, method=method, reason=reason)


def _kappas(tables: Floats) -> Floats:
    """Return weighted kappa of each table of first by second answers; NaN for one answer only."""
    score = np.arange(tables.shape[1])
    weights = ((score[:, None] - score) ** 2).astype(np.float64)
    count = tables.sum(axis=(1, 2))
    observed = np.einsum("tij,ij->t", tables, weights)
    before, after = tables.sum(axis=2), tables.sum(axis=1)
    expected = np.einsum("ti,tj,ij->t", before, after, weights) / count
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(expected > 0, 1 - observed / expected, math.nan)


def _spearman(first: NDArray[np.int64], repeat: NDArray[np.int64]) -> float:
    if not (np.ptp(first) and np.ptp(repeat)):
        return math.nan
    return float(stats.spearmanr(first, repeat).statistic)


def _drawn_tables(tables: Floats, resamples: int, seed: int) -> Iterator[Floats]:
    """Give the summed tables of resampled items or participants, shape (resamples, k, k)."""
    chance = np.random.default_rng(seed)
    count, size, _ = tables.shape
    flat = tables.reshape(count, -1)
    for start in range(0, resamples, BLOCK):
        block = min(BLOCK, resamples - start)
        times = chance.multinomial(count, np.full(count, 1 / count), size=block)
        yield (times @ flat).reshape(block, size, size)
