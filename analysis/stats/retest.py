"""Test-retest: how far participants agree with themselves when trials are shown again."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.two_way_bootstrap import percentile_interval

Floats = NDArray[np.float64]

RESAMPLES: Final = 2000
BLOCK: Final = 200
"""Resamples drawn at a time: bounds the memory."""


@dataclass(frozen=True, kw_only=True)
class Retest:
    """How far participants agree with themselves.

    Attributes
    ----------
    kappa : float
        Cohen's weighted kappa, quadratic weights: 1 for the same answers, 0 for as much agreement
        as chance gives; NaN where there is none.
    low, high : float
        Ends of its 95 % interval, participants drawn again; NaN where there is none.
    equal_share : float
        Share of the pairs with the same answer; NaN without any.
    equal_low, equal_high : float
        Ends of its 95 % interval; NaN where there is none.
    spearman : float
        Rank correlation; NaN where one side's answers are all alike.
    n, participants : int
        Trials answered twice, and by how many.
    method : str
        How the intervals were found; empty where there are none.
    reason : str
        Why a number is missing; empty where none is.
    """

    kappa: float = math.nan
    low: float = math.nan
    high: float = math.nan
    equal_share: float = math.nan
    equal_low: float = math.nan
    equal_high: float = math.nan
    spearman: float = math.nan
    n: int
    participants: int
    method: str = ""
    reason: str = ""


def retest_agreement(
    first: NDArray[np.integer],
    again: NDArray[np.integer],
    participants: NDArray[np.generic],
    *,
    resamples: int = RESAMPLES,
    seed: int = 0,
) -> Retest:
    """Compare the answers to trials with those to their repeats (Cohen 1968).

    Parameters
    ----------
    first, again : ndarray of int, shape (N,)
        Answers as equally spaced numbers.
    participants : ndarray, shape (N,)
        Who gave them.
    resamples, seed : int
        Bootstrap resamples of the participants, and what draws them.
    """
    before, after = np.asarray(first, np.int64), np.asarray(again, np.int64)
    who = np.unique(participants, return_inverse=True)[1]
    people = int(who.max(initial=-1)) + 1
    unknown = Retest(n=len(before), participants=people)
    if not len(before):
        return replace(unknown, reason="no trial was answered again")
    lowest = int(min(before.min(), after.min()))
    scores = int(max(before.max(), after.max())) - lowest + 1
    cells = (who * scores + before - lowest) * scores + after - lowest
    tables = np.bincount(cells, minlength=people * scores**2).reshape(people, scores, scores)
    [kappa] = _kappas(tables.sum(axis=0)[None])
    found = replace(
        unknown,
        kappa=float(kappa),
        spearman=_spearman(before, after),
        equal_share=float((before == after).mean()),
    )
    if people < 2:
        return replace(found, reason="one participant gives no interval")
    kappas, equal = _drawn(tables, resamples, seed)
    equal_low, equal_high = percentile_interval(equal)
    found = replace(
        found,
        equal_low=equal_low,
        equal_high=equal_high,
        method=f"bootstrap over participants, {resamples} resamples",
    )
    if math.isnan(found.kappa):
        return replace(found, reason="all answers alike")
    low, high = percentile_interval(kappas)
    reason = "one side's answers are all alike" if math.isnan(found.spearman) else ""
    return replace(found, low=low, high=high, reason=reason)


def _kappas(tables: NDArray[np.int64]) -> Floats:
    """Return weighted kappa of each table of first by second answers; NaN for one answer only."""
    score = np.arange(tables.shape[1])
    weights = ((score[:, None] - score) ** 2).astype(np.float64)
    count = tables.sum(axis=(1, 2))
    observed = np.einsum("tij,ij->t", tables, weights)
    before, after = tables.sum(axis=2), tables.sum(axis=1)
    expected = np.einsum("ti,tj,ij->t", before, after, weights) / count
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(expected > 0, 1 - observed / expected, math.nan)


def _spearman(first: NDArray[np.int64], again: NDArray[np.int64]) -> float:
    if not (np.ptp(first) and np.ptp(again)):
        return math.nan
    return float(stats.spearmanr(first, again).statistic)


def _drawn(tables: NDArray[np.int64], resamples: int, seed: int) -> tuple[Floats, Floats]:
    """Return kappa and the share of equal answers of resampled participants."""
    chance = np.random.default_rng(seed)
    people, scores, _ = tables.shape
    flat = tables.reshape(people, -1)
    kappas, equal = [], []
    for start in range(0, resamples, BLOCK):
        size = min(BLOCK, resamples - start)
        times = chance.multinomial(people, np.full(people, 1 / people), size=size)
        drawn = (times @ flat).reshape(size, scores, scores)
        kappas.append(_kappas(drawn))
        equal.append(np.trace(drawn, axis1=1, axis2=2) / drawn.sum(axis=(1, 2)))
    return np.concatenate(kappas), np.concatenate(equal)
