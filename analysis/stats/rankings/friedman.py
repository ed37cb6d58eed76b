"""Friedman's test and Iman and Davenport's F: whether conditions differ within participants.

Blocks are participants, each with one number per condition: their mean over segments. Participant
and segment together are no block: single answers are not independent, and a test over them finds
differences that are not there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.finite import finite
from analysis.stats.rankings.placements import Placements, condition_columns
from analysis.stats.tied_ranks import tied_ranks

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class Blocks:
    """One number for each participant and condition.

    Attributes
    ----------
    conditions : tuple of str
        Names of the columns.
    means : ndarray, shape (participants, conditions)
        The larger, the better; of those who have answered about every condition.
    incomplete : int
        Participants left out because they have not.
    """

    conditions: tuple[str, ...]
    means: Floats
    incomplete: int = 0

    @cached_property
    def ranks(self) -> Floats:
        """Ranks within each participant, from 1, the smallest; ties share the mean of theirs."""
        return tied_ranks(self.means)


@dataclass(frozen=True, kw_only=True)
class Friedman:
    """Whether the conditions differ.

    Attributes
    ----------
    mean_ranks : dict of str to float
        Mean rank of each condition, the larger the better; NaN without participants.
    statistic, freedom, p_value : float
        Friedman's chi-square, corrected for ties.
    f_statistic, f_p : float
        Iman & Davenport's (1980) F, which is less conservative, and its p value.
    f_freedom : (int, int)
        Its degrees of freedom.
    kendall_w : float
        The same as concordance: 0 none, 1 all participants rank alike.
    n, incomplete : int
        Participants it rests on, and those left out.
    reason : str
        Why there is no test; empty where there is one.
    """

    mean_ranks: dict[str, float]
    statistic: float
    freedom: int
    p_value: float
    f_statistic: float
    f_freedom: tuple[int, int]
    f_p: float
    kendall_w: float
    n: int
    incomplete: int
    reason: str = ""


def blocks_of_ratings(answers: pd.DataFrame, conditions: Sequence[str]) -> Blocks:
    """Return each participant's mean rating of each condition.

    Parameters
    ----------
    answers : DataFrame
        Columns `participant`, `condition` and `value`.
    conditions : sequence of str
        In the order wanted.
    """
    columns = condition_columns(answers["condition"], conditions)
    own = columns >= 0
    people = pd.factorize(answers["participant"])[0][own]
    return _blocks(conditions, people, columns[own], finite(answers["value"].to_numpy()[own]))


def blocks_of_rankings(rankings: Placements) -> Blocks:
    """Return each participant's mean rank of each condition, turned so that more is better."""
    rows, columns = np.nonzero(~np.isnan(rankings.given))
    places = len(rankings.conditions) + 1 - rankings.ranks[rows, columns]
    return _blocks(rankings.conditions, rankings.participants[rows], columns, places)


def friedman(blocks: Blocks) -> Friedman:
    """Test whether any condition is placed otherwise than the others (Friedman 1937)."""
    count, width = blocks.means.shape
    mean_ranks = blocks.ranks.mean(axis=0) if count else np.full(width, math.nan)
    unknown = Friedman(
        mean_ranks=dict(zip(blocks.conditions, mean_ranks.tolist(), strict=True)),
        statistic=math.nan,
        freedom=max(width - 1, 0),
        p_value=math.nan,
        f_statistic=math.nan,
        f_freedom=(max(width - 1, 0), max(width - 1, 0) * max(count - 1, 0)),
        f_p=math.nan,
        kendall_w=math.nan,
        n=count,
        incomplete=blocks.incomplete,
    )
    if width < 2:
        return replace(unknown, reason="fewer than two conditions")
    if count < 2:
        return replace(unknown, reason="fewer than two participants with all conditions")
    within = float(((blocks.ranks - (width + 1) / 2) ** 2).sum())
    if not within:
        return replace(unknown, reason="nobody tells conditions apart")
    largest = count * (width - 1)
    between = count * float(((mean_ranks - (width + 1) / 2) ** 2).sum())
    concordance = min(1.0, between / within)
    statistic = largest * concordance
    alike = math.isclose(concordance, 1.0, rel_tol=1e-12)
    f_statistic = math.inf if alike else (count - 1) * concordance / (1 - concordance)
    return replace(
        unknown,
        statistic=statistic,
        p_value=float(stats.chi2.sf(statistic, width - 1)),
        f_statistic=f_statistic,
        f_p=float(stats.f.sf(f_statistic, *unknown.f_freedom)),
        kendall_w=concordance,
    )


def _blocks(
    conditions: Sequence[str],
    people: NDArray[np.intp],
    columns: NDArray[np.intp],
    values: Floats,
) -> Blocks:
    width = len(conditions)
    count = int(people.max(initial=-1)) + 1
    cells = people * width + columns
    sums = np.bincount(cells, weights=values, minlength=count * width)
    counts = np.bincount(cells, minlength=count * width).reshape(count, width)
    complete = (counts > 0).all(axis=1)
    return Blocks(
        conditions=tuple(conditions),
        means=sums.reshape(count, width)[complete] / counts[complete],
        incomplete=int((counts.any(axis=1) & ~complete).sum()),
    )
