"""Rankings: the ranks of each condition, and tests whether conditions are ranked differently.

Blocks of Friedman's test are participants, each with one number per condition: their mean over
segments. Pairs of participant and segment cannot be blocks: single answers are not independent, and
a test over them finds differences that do not exist.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np
import pandas as pd
from scipy import stats

from analysis.stats.clustered_mean import Estimate, clustered_mean
from analysis.stats.multiple_testing import holm
from analysis.stats.one_sample_tests import signed_rank
from analysis.stats.samples import tied_ranks
from motion.arrays import Bools, Floats, Indices


@dataclass(frozen=True, kw_only=True, eq=False)
class Placements:
    """The rankings of one question.

    Attributes
    ----------
    conditions : tuple of str
        Names of the columns.
    given : ndarray, shape (rankings, conditions)
        Numbers as given: the smaller, the better; equal numbers are a tie; NaN if a ranking omits a
        condition.
    participants, segments : ndarray of int, shape (rankings,)
        The participant and the segment of each ranking, from 0.
    participant_names, segment_names : tuple
        The names behind those numbers.
    """

    conditions: tuple[str, ...]
    given: Floats
    participants: Indices
    segments: Indices
    participant_names: tuple[str, ...]
    segment_names: tuple[str, ...]

    @cached_property
    def better(self) -> Floats:
        """Number of conditions ahead of each one in its ranking; NaN if omitted."""
        return self._compared(np.less)

    @cached_property
    def tied(self) -> Floats:
        """Number of conditions tied with each one, itself included; NaN if omitted."""
        return self._compared(np.equal)

    @cached_property
    def ranks(self) -> Floats:
        """Ranks from 1; tied conditions share their mean rank. NaN if omitted."""
        return self.better + (self.tied + 1) / 2

    @cached_property
    def complete(self) -> Bools:
        """Mask of the rankings that place every condition."""
        return np.asarray(~np.isnan(self.given).any(axis=1))

    def averaged(self) -> Placements:
        """Return one ranking for each participant and segment, by mean ranks."""
        cells, cell = np.unique(
            np.column_stack([self.participants, self.segments]), axis=0, return_inverse=True
        )
        if len(cells) == len(self.given):
            return self
        cell = cell.ravel()
        placed = ~np.isnan(self.given)
        sums, counts = np.zeros((2, len(cells), len(self.conditions)))
        np.add.at(sums, cell, np.where(placed, self.ranks, 0.0))
        np.add.at(counts, cell, placed)
        with np.errstate(invalid="ignore"):
            means = sums / counts
        return replace(self, given=means, participants=cells[:, 0], segments=cells[:, 1])

    def _compared(self, how: np.ufunc) -> Floats:
        counts = np.zeros_like(self.given)
        for other in range(len(self.conditions)):
            counts += how(self.given[:, [other]], self.given)
        counts[np.isnan(self.given)] = np.nan
        return counts


def placements(answers: pd.DataFrame, conditions: Sequence[str]) -> Placements:
    """Arrange the ranks given in answer to one question.

    Parameters
    ----------
    answers : DataFrame
        Columns `participant`, `segment`, `condition` and `rank` (1 is best, equal numbers are a
        tie), one row per placed condition; `trial`, if somebody ranked a segment repeatedly. No
        ranking places a condition twice.
    conditions : sequence of str
        All conditions, in the order of the columns.
    """
    columns = pd.Index(list(conditions)).get_indexer(
        pd.Index(answers["condition"].to_numpy(object))
    )
    known = columns >= 0
    answers, columns = answers[known], columns[known]
    participants, participant_names = pd.factorize(answers["participant"])
    segments, segment_names = pd.factorize(answers["segment"])
    trials = pd.factorize(answers["trial"])[0] if "trial" in answers else np.zeros_like(segments)
    keys = np.column_stack([participants, segments, trials])
    rankings, rows = np.unique(keys, axis=0, return_inverse=True)
    rows = rows.ravel()
    ranks = np.full((len(rankings), len(conditions)), np.nan)
    ranks[rows, columns] = answers["rank"].to_numpy(np.float64)
    return Placements(
        conditions=tuple(conditions),
        given=ranks,
        participants=rankings[:, 0],
        segments=rankings[:, 1],
        participant_names=tuple(map(str, participant_names)),
        segment_names=tuple(map(str, segment_names)),
    )


@dataclass(frozen=True, kw_only=True)
class RankSummary:
    """The ranks of one condition.

    Attributes
    ----------
    condition : str
        The condition's name.
    n : int
        Number of rankings that place it.
    mean_rank : Estimate
        Mean rank; 1 is best, and tied conditions share their mean rank. Tested against the middle
        rank of the conditions that were ranked together.
    first_share : Estimate
        Share of the rankings in which it is best; conditions tied for first share one ranking.
        Tested against chance.
    rank_percent : mapping of int to float
        Share of each place, in percent; ties are spread evenly over their places. NaN without
        rankings.
    remark : str
        A caution about the numbers; empty if there is none.
    """

    condition: str
    n: int
    mean_rank: Estimate
    first_share: Estimate
    rank_percent: Mapping[int, float]
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
    count = len(rankings.conditions)
    placed = ~np.isnan(rankings.given[:, column])
    better, tied = rankings.better[placed, column], rankings.tied[placed, column]
    participants, segments = rankings.participants[placed], rankings.segments[placed]
    rank = np.arange(1, count + 1)
    shares = ((better[:, None] < rank) & (rank <= (better + tied)[:, None])) / tied[:, None]
    n = int(placed.sum())
    percent = (100 * shares.mean(axis=0)).tolist() if n else [math.nan] * count
    partial = int((placed & ~rankings.complete).sum())
    # A ranking of fewer conditions has fewer places.
    ranked = (~np.isnan(rankings.given[placed])).sum(axis=1)
    return RankSummary(
        condition=condition,
        n=n,
        mean_rank=clustered_mean(
            rankings.ranks[placed, column],
            participants,
            segments,
            null=float((ranked + 1).mean() / 2) if n else math.nan,
            limits=(1, count),
        ),
        first_share=clustered_mean(
            shares[:, 0],
            participants,
            segments,
            null=float((1 / ranked).mean()) if n else math.nan,
        ),
        rank_percent=dict(enumerate(percent, start=1)),
        remark=f"{partial} of {n} rankings leave conditions out" if partial else "",
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Blocks:
    """One number for each participant and condition.

    Attributes
    ----------
    conditions : tuple of str
        Names of the columns.
    means : ndarray, shape (participants, conditions)
        The larger, the better; only of participants who answered about every condition.
    incomplete : int
        Number of participants left out because they did not.
    """

    conditions: tuple[str, ...]
    means: Floats
    incomplete: int = 0

    @cached_property
    def ranks(self) -> Floats:
        """Ranks within each participant, 1 for the smallest mean; ties share their mean rank."""
        return tied_ranks(self.means)


def blocks_of_rankings(rankings: Placements) -> Blocks:
    """Return each participant's mean rank of each condition, reversed so that larger is better."""
    rows, columns = np.nonzero(~np.isnan(rankings.given))
    width, participants = len(rankings.conditions), rankings.participants[rows]
    count = int(participants.max(initial=-1)) + 1
    cells = participants * width + columns
    places = width + 1 - rankings.ranks[rows, columns]
    sums = np.bincount(cells, weights=places, minlength=count * width)
    counts = np.bincount(cells, minlength=count * width).reshape(count, width)
    complete = (counts > 0).all(axis=1)
    return Blocks(
        conditions=rankings.conditions,
        means=sums.reshape(count, width)[complete] / counts[complete],
        incomplete=int((counts.any(axis=1) & ~complete).sum()),
    )


@dataclass(frozen=True, kw_only=True)
class Friedman:
    """Friedman's test whether conditions differ.

    Attributes
    ----------
    mean_ranks : dict of str to float
        Mean rank of each condition, the larger the better; NaN without participants.
    statistic, df, p_value : float
        Friedman's chi-square, corrected for ties.
    kendall_w : float
        Concordance: 0 for none, 1 if all participants rank alike.
    n, incomplete : int
        Number of participants, and of those left out.
    reason : str
        Why there is no test; empty if there is one.
    """

    mean_ranks: dict[str, float]
    statistic: float = math.nan
    df: int
    p_value: float = math.nan
    kendall_w: float = math.nan
    n: int
    incomplete: int
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class PairwiseRanks:
    """The difference of two conditions over participants.

    Attributes
    ----------
    a, b : str
        The conditions.
    difference : float
        Mean rank of a minus that of b over participants, each ranked by their means: below zero if
        a is better; NaN without a test.
    nemenyi_p : float
        p-value of the Studentised range, which corrects for all pairs.
    conover_p, conover_holm : float
        p-values of Conover & Iman's t, plain and after Holm's correction.
    wilcoxon_p, wilcoxon_holm : float
        Signed-rank p-values of the participants' differences, plain and after Holm's correction.
    n : int
        Number of participants.
    reason : str
        Why a number is missing; empty if none is.
    """

    a: str
    b: str
    difference: float = math.nan
    nemenyi_p: float = math.nan
    conover_p: float = math.nan
    conover_holm: float = math.nan
    wilcoxon_p: float
    wilcoxon_holm: float = math.nan
    n: int
    reason: str = ""


def friedman(blocks: Blocks) -> Friedman:
    """Test whether any condition is ranked differently from the others (Friedman 1937)."""
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
        return replace(unknown, reason=reason)
    between = count * float(((mean_ranks - (width + 1) / 2) ** 2).sum())
    concordance = min(1.0, between / within)
    statistic = count * unknown.df * concordance
    return replace(
        unknown,
        statistic=statistic,
        p_value=float(stats.chi2.sf(statistic, unknown.df)),
        kendall_w=concordance,
    )


def _why_not(participants: int, conditions: int, within: float) -> str:
    if conditions < 2:
        return "fewer than two conditions"
    if participants < 2:
        return "fewer than two participants with all conditions"
    return "" if within else "nobody tells conditions apart"


def compare_pairs(blocks: Blocks) -> tuple[PairwiseRanks, ...]:
    """Compare all pairs of conditions (Nemenyi 1963; Conover 1999; Wilcoxon 1945).

    Holm's corrections are over all pairs returned.
    """
    whole = friedman(blocks)
    pairs = [
        _pair(blocks, a, b, whole.reason) for a, b in combinations(range(len(blocks.conditions)), 2)
    ]
    corrected = holm([pair.conover_p for pair in pairs]), holm([pair.wilcoxon_p for pair in pairs])
    return tuple(
        replace(pair, conover_holm=conover, wilcoxon_holm=wilcoxon)
        for pair, conover, wilcoxon in zip(pairs, *corrected, strict=True)
    )


def _pair(blocks: Blocks, a: int, b: int, reason: str) -> PairwiseRanks:
    count, width = blocks.means.shape
    ranks = signed_rank(blocks.means[:, a] - blocks.means[:, b])
    comparison = PairwiseRanks(
        a=blocks.conditions[a],
        b=blocks.conditions[b],
        wilcoxon_p=ranks.p_value,
        n=count,
        reason=reason or ranks.reason,
    )
    if reason:
        return comparison
    means = blocks.ranks.mean(axis=0)
    difference = float(means[b] - means[a])
    studentized = abs(difference) / math.sqrt(width * (width + 1) / (12 * count))
    # The ranks' variance within participants that conditions do not explain.
    residual = float((blocks.ranks**2).sum()) - count * float((means**2).sum())
    freedom = (count - 1) * (width - 1)
    error = math.sqrt(2 * max(residual, 0.0) / (count * freedom))
    if error > 1e-9:
        conover = float(2 * stats.t.sf(abs(difference) / error, freedom))
    else:
        conover = 1.0 if difference == 0 else 0.0
    return replace(
        comparison,
        difference=difference,
        nemenyi_p=float(np.clip(stats.studentized_range.sf(studentized, width, np.inf), 0, 1)),
        conover_p=conover,
    )
