"""The intraclass correlation: the share of the answers' variance between items.

Two-way random effects, absolute agreement: participants who use the scale differently disagree.
'Single' refers to one participant's answers, 'average' to the mean over an item's participants.
"""

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.clustered_mean import Interval
from motion.arrays import Floats, Indices

COMPLETE: Final = "two-way random effects, absolute agreement"
INCOMPLETE: Final = (
    "two-way random effects, absolute agreement; answers are missing, so that variances are "
    "Henderson's and intervals approximate"
)


TOO_FEW: Final = "too few participants share items to tell them apart"

UNKNOWN: Final = Interval()


@dataclass(frozen=True, kw_only=True)
class Intraclass:
    """Agreement of participants' numbers about the items.

    Attributes
    ----------
    single, average : Interval
        Correlation of one participant's answers, and of the mean over an item's participants. In
        [-1, 1]; below 0 if items differ less than by chance.
    item_variance, rater_variance, residual_variance : float
        Components of the answers' variance; an estimate may be negative.
    participants_per_item : float
        Harmonic mean number of participants per item, to which `average` refers.
    n, items, participants : int
        Numbers of answers, items and participants.
    method : str
        The kind of correlation, and whether answers are missing.
    reason : str
        Why there is no correlation; empty if there is one.
    """

    single: Interval = UNKNOWN
    average: Interval = UNKNOWN
    item_variance: float = math.nan
    rater_variance: float = math.nan
    residual_variance: float = math.nan
    participants_per_item: float
    n: int
    items: int
    participants: int
    method: str = ""
    reason: str = ""


def intraclass_correlation(
    values: NDArray[np.number], raters: NDArray[np.generic], items: NDArray[np.generic]
) -> Intraclass:
    """Estimate the intraclass correlations ICC(A,1) and ICC(A,k) of McGraw & Wong (1996).

    Shrout & Fleiss (1979) call them ICC(2,1) and ICC(2,k). If answers are missing, the variances
    are those of Henderson's (1953) first method, which agree with the usual ones if none are
    missing; the intervals then treat the table as complete, with the (harmonic) mean numbers of
    answers.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Answers as numbers.
    raters, items : ndarray, shape (N,)
        The rater and the item of each answer; at most one answer for each pair.
    """
    y = np.asarray(values, np.float64)
    rater_codes, item_codes = pd.factorize(raters)[0], pd.factorize(items)[0]
    rater_count, item_count = (int(c.max(initial=-1)) + 1 for c in (rater_codes, item_codes))
    complete = len(y) == rater_count * item_count
    unknown = Intraclass(
        participants_per_item=float(stats.hmean(np.bincount(item_codes))),
        n=len(y),
        items=item_count,
        participants=rater_count,
    )
    if reason := _why_not(y, item_count, rater_count):
        return _without(unknown, reason)
    item, rater, residual = _variances(y, rater_codes, item_codes)
    components = replace(
        unknown,
        item_variance=item,
        rater_variance=rater,
        residual_variance=residual,
        method=COMPLETE if complete else INCOMPLETE,
    )
    if item + rater + residual <= 0 or residual < 0:
        return _without(components, "the variances come out negative")
    estimate = item / (item + rater + residual)
    low, high = _interval(components, estimate, float(stats.hmean(np.bincount(rater_codes))))
    per_item = components.participants_per_item
    return replace(
        components,
        single=Interval(estimate=estimate, low=low, high=high),
        average=Interval(
            estimate=_of_the_mean(estimate, per_item),
            low=_of_the_mean(low, per_item),
            high=_of_the_mean(high, per_item),
        ),
    )


def _without(components: Intraclass, reason: str) -> Intraclass:
    missing = Interval(reason=reason)
    return replace(components, single=missing, average=missing, reason=reason)


def _why_not(y: Floats, items: int, raters: int) -> str:
    if items < 2:
        return "one item"
    if raters < 2:
        return "one participant"
    if len(y) <= items + raters - 1:
        return TOO_FEW
    if not np.ptp(y):
        return "all answers alike"
    return ""


def _variances(y: Floats, raters: Indices, items: Indices) -> tuple[float, float, float]:
    """Return item, rater and residual variances (Henderson's method 1).

    The expectation of each of three sums of squares is a known mixture of them.
    """
    count = len(y)
    by_item, by_rater = np.bincount(items), np.bincount(raters)
    centred = y - y.mean()
    squares = np.array(
        [
            centred @ centred,
            np.sum(np.bincount(items, weights=centred) ** 2 / by_item),
            np.sum(np.bincount(raters, weights=centred) ** 2 / by_rater),
        ]
    )
    item_share, rater_share = (by_item**2).sum() / count, (by_rater**2).sum() / count
    mixture = np.array(
        [
            [count - item_share, count - rater_share, count - 1],
            [count - item_share, len(by_item) - rater_share, len(by_item) - 1],
            [len(by_rater) - item_share, count - rater_share, len(by_rater) - 1],
        ]
    )
    # It is singular only if one item, or one rater, has all answers.
    components = np.linalg.solve(mixture, squares)
    # Variances that are rounding errors are zero.
    components[np.abs(components) < 1e-12 * np.abs(components).max()] = 0.0
    item, rater, residual = components.tolist()
    return item, rater, residual


def _interval(
    components: Intraclass, estimate: float, items_per_rater: float
) -> tuple[float, float]:
    """Return the 95% interval of the single correlation (McGraw & Wong 1996, case A,1)."""
    if not components.rater_variance and not components.residual_variance:
        return 1.0, 1.0
    k, n = components.participants_per_item, items_per_rater
    noise = components.residual_variance
    # A negative component may leave less than the noise, but no negative mean square.
    between = max(k * components.item_variance + noise, 0.0)
    raters = max(n * components.rater_variance + noise, 0.0)
    df_rest = components.n - components.items - components.participants + 1
    correlation = min(max(estimate, 0.0), 1 - 1e-9)
    a = k * correlation / (n * (1 - correlation))
    b = 1 + a * (n - 1)
    of_raters, of_rest = a * raters, b * noise
    freedom = float(df_rest)
    if of_raters:
        freedom = (of_raters + of_rest) ** 2 / (
            of_raters**2 / (components.participants - 1) + of_rest**2 / df_rest
        )
    high_f = stats.f.ppf(0.975, components.items - 1, freedom)
    low_f = stats.f.ppf(0.975, freedom, components.items - 1)
    mixed = k * raters + (k * n - k - n) * noise
    low = n * (between - high_f * noise) / (high_f * mixed + n * between)
    high = n * (low_f * between - noise) / (mixed + n * low_f * between)
    return float(low), float(high)


def _of_the_mean(single: float, raters: float) -> float:
    """Return the correlation of a mean over `raters` (Spearman & Brown), cut at -1."""
    if single <= -1 / (raters + 1):
        return -1.0
    return raters * single / (1 + (raters - 1) * single)
