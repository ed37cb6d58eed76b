"""Krippendorff's alpha, with an interval from drawing the items again.

Alpha is 1 where all participants agree, 0 where they agree as far as chance would make them. A
real effect may come with an alpha near zero: that all prefer one condition slightly, each in other
items, is agreement about the condition and not about the items.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.stats.two_way_bootstrap import percentile_interval
from analysis.stats.values import finite
from motion.errors import InputError

Floats = NDArray[np.float64]
Level = Literal["nominal", "ordinal", "interval", "ratio"]

RESAMPLES: Final = 2000
BLOCK: Final = 200
"""Resamples drawn at a time: bounds the memory."""


@dataclass(frozen=True, kw_only=True)
class Alpha:
    """Krippendorff's alpha.

    Attributes
    ----------
    estimate : float
        At most 1; NaN where there is none.
    low, high : float
        Ends of its 95 % interval over items; NaN where there is none.
    level : {'nominal', 'ordinal', 'interval', 'ratio'}
        How far apart two values are taken to be.
    n, items, participants : int
        What it rests on: answers about items that at least two participants answered about.
    method : str
        How the interval was found; empty where there is none.
    reason : str
        Why there is no alpha, or no interval; empty where there are both.
    """

    estimate: float = math.nan
    low: float = math.nan
    high: float = math.nan
    level: Level
    n: int
    items: int
    participants: int
    method: str = ""
    reason: str = ""


def krippendorff_alpha(
    values: NDArray[np.number],
    raters: NDArray[np.generic],
    items: NDArray[np.generic],
    *,
    level: Level = "ordinal",
    resamples: int = RESAMPLES,
    seed: int = 0,
) -> Alpha:
    """Estimate alpha from answers, of which some may be missing (Krippendorff 2011).

    Parameters
    ----------
    values : ndarray, shape (N,)
        Answers as numbers in their order.
    raters, items : ndarray, shape (N,)
        Who answered about what; one answer of each about each.
    level : {'nominal', 'ordinal', 'interval', 'ratio'}
        Scale of the values.
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
    unknown = Alpha(
        level=level, n=len(table), items=count, participants=int(table["rater"].nunique())
    )
    if not count:
        return replace(unknown, reason="no item was answered about by two participants")
    if len(domain) < 2:
        return replace(unknown, reason="all answers alike")
    cells = np.bincount(rows * len(domain) + codes, minlength=count * len(domain))
    coincidences = _coincidences(cells.reshape(count, len(domain)).astype(np.float64))
    [estimate] = _alphas(coincidences.sum(axis=0)[None], domain, level)
    found = replace(unknown, estimate=float(estimate))
    if count < 2:
        return replace(found, reason="one item gives no interval")
    low, high = percentile_interval(_drawn(coincidences, domain, level, resamples, seed))
    return replace(found, low=low, high=high, method=f"bootstrap over items, {resamples} resamples")


def _coincidences(counts: Floats) -> Floats:
    """Return each item's pairs of values, (items, values, values), from its counts of values."""
    pairs = counts[:, :, None] * counts[:, None, :]
    places = np.arange(counts.shape[1])
    pairs[:, places, places] -= counts
    return np.asarray(pairs / (counts.sum(axis=1) - 1)[:, None, None], np.float64)


def _alphas(coincidences: Floats, domain: Floats, level: Level) -> Floats:
    """Return alpha of each table of coincidences, (tables, values, values); NaN for one value."""
    totals = coincidences.sum(axis=2)
    count = totals.sum(axis=1)
    apart = _squared_distances(domain, totals, level)
    observed = np.einsum("tij,tij->t", coincidences, apart)
    expected = np.einsum("ti,tj,tij->t", totals, totals, apart) / (count - 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(expected > 0, 1 - observed / expected, math.nan)


def _squared_distances(domain: Floats, totals: Floats, level: Level) -> Floats:
    """Return how far values are apart, squared; between ordinal ones lie the answers between."""
    if level == "ordinal":
        middles = np.cumsum(totals, axis=1) - totals / 2
        return np.asarray((middles[:, :, None] - middles[:, None, :]) ** 2, np.float64)
    difference = domain[:, None] - domain
    if level == "nominal":
        return np.asarray(difference != 0, np.float64)[None]
    if level == "ratio":
        total = domain[:, None] + domain
        difference = np.divide(difference, total, out=np.zeros_like(difference), where=total != 0)
    return np.asarray(difference[None] ** 2, np.float64)


def _drawn(coincidences: Floats, domain: Floats, level: Level, resamples: int, seed: int) -> Floats:
    """Return alpha of resampled items; resamples in which all agree on one value are left out."""
    chance = np.random.default_rng(seed)
    count, size, _ = coincidences.shape
    flat = coincidences.reshape(count, -1)
    found = []
    for start in range(0, resamples, BLOCK):
        block = min(BLOCK, resamples - start)
        times = chance.multinomial(count, np.full(count, 1 / count), size=block)
        found.append(_alphas((times @ flat).reshape(block, size, size), domain, level))
    return np.concatenate(found)
