"""Friedman's test, and Nemenyi's, Conover's and Wilcoxon's pair by pair after it.

Blocks are participants, each with one number per condition: their mean over segments. Participant
and segment together are no block: single answers are not independent, and a test over them finds
differences that are not there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.stats.holm import holm
from analysis.stats.min_f import FTest
from analysis.stats.rankings.placements import Placements
from analysis.stats.values import tied_ranks
from analysis.stats.wilcoxon import signed_rank

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
    statistic, df, p_value : float
        Friedman's chi-square, corrected for ties.
    iman_davenport : FTest
        Iman & Davenport's (1980) F, which is less conservative.
    kendall_w : float
        The same as concordance: 0 none, 1 all participants rank alike.
    n, incomplete : int
        Participants it rests on, and those left out.
    reason : str
        Why there is no test; empty where there is one.
    """

    mean_ranks: dict[str, float]
    statistic: float = math.nan
    df: int
    p_value: float = math.nan
    iman_davenport: FTest = field(default_factory=FTest)
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
    wilcoxon_normal_p, wilcoxon_normal_holm : float
        The same by the normal approximation, as other software gives it.
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
    wilcoxon_normal_p: float
    wilcoxon_normal_holm: float = math.nan
    n: int
    reason: str = ""


def blocks_of_rankings(rankings: Placements) -> Blocks:
    """Return each participant's mean rank of each condition, turned so that more is better."""
    rows, columns = np.nonzero(~np.isnan(rankings.given))
    width, people = len(rankings.conditions), rankings.participants[rows]
    count = int(people.max(initial=-1)) + 1
    cells = people * width + columns
    places = width + 1 - rankings.ranks[rows, columns]
    sums = np.bincount(cells, weights=places, minlength=count * width)
    counts = np.bincount(cells, minlength=count * width).reshape(count, width)
    complete = (counts > 0).all(axis=1)
    return Blocks(
        conditions=rankings.conditions,
        means=sums.reshape(count, width)[complete] / counts[complete],
        incomplete=int((counts.any(axis=1) & ~complete).sum()),
    )


def friedman(blocks: Blocks) -> Friedman:
    """Test whether any condition is placed otherwise than the others (Friedman 1937)."""
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
        return replace(unknown, iman_davenport=FTest(reason=reason), reason=reason)
    between = count * float(((mean_ranks - (width + 1) / 2) ** 2).sum())
    concordance = min(1.0, between / within)
    statistic = count * unknown.df * concordance
    alike = math.isclose(concordance, 1.0, rel_tol=1e-12)
    f = math.inf if alike else (count - 1) * concordance / (1 - concordance)
    rest = unknown.df * (count - 1)
    return replace(
        unknown,
        statistic=statistic,
        p_value=float(stats.chi2.sf(statistic, unknown.df)),
        iman_davenport=FTest(
            statistic=f,
            df=unknown.df,
            df_rest=rest,
            p_value=float(stats.f.sf(f, unknown.df, rest)),
            reason="all participants rank alike: F is infinite" if alike else "",
        ),
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
    found = [
        _pair(blocks, a, b, whole.reason) for a, b in combinations(range(len(blocks.conditions)), 2)
    ]
    corrected = (
        holm([pair.conover_p for pair in found]),
        holm([pair.wilcoxon_p for pair in found]),
        holm([pair.wilcoxon_normal_p for pair in found]),
    )
    return tuple(
        replace(pair, conover_holm=conover, wilcoxon_holm=exact, wilcoxon_normal_holm=normal)
        for pair, conover, exact, normal in zip(found, *corrected, strict=True)
    )


def _pair(blocks: Blocks, a: int, b: int, reason: str) -> PairwiseRanks:
    count, width = blocks.means.shape
    ranks = signed_rank(blocks.means[:, a] - blocks.means[:, b])
    found = PairwiseRanks(
        a=blocks.conditions[a],
        b=blocks.conditions[b],
        wilcoxon_p=ranks.p_value,
        wilcoxon_normal_p=ranks.normal_p,
        n=count,
        reason=reason or ranks.reason,
    )
    if reason:
        return found
    means = blocks.ranks.mean(axis=0)
    difference = float(means[b] - means[a])
    ranged = abs(difference) / math.sqrt(width * (width + 1) / (12 * count))
    # What is left of the ranks' variance within participants once conditions are taken out.
    rest = float((blocks.ranks**2).sum()) - count * float((means**2).sum())
    freedom = (count - 1) * (width - 1)
    error = math.sqrt(2 * max(rest, 0.0) / (count * freedom))
    if error > 1e-9:
        conover = float(2 * stats.t.sf(abs(difference) / error, freedom))
    else:
        conover = 1.0 if difference == 0 else 0.0
    return replace(
        found,
        difference=difference,
        nemenyi_p=float(np.clip(stats.studentized_range.sf(ranged, width, np.inf), 0, 1)),
        conover_p=conover,
    )
