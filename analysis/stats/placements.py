"""Rankings as a table, and where each condition is placed (Figure 7 of DiffSHEG)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.stats.clustered_mean import Estimate, clustered_mean
from analysis.stats.samples import tied_ranks
from motion.errors import InputError

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class Placements:
    """Who ranked which segment's conditions how.

    Attributes
    ----------
    conditions : tuple of str
        Names of the columns.
    given : ndarray, shape (rankings, conditions)
        Numbers as they were given: the smaller, the better; equal ones are a tie; NaN where a
        ranking leaves a condition out.
    participants, segments : ndarray of int, shape (rankings,)
        Whose ranking it is, and of which segment; from 0.
    participant_names, segment_names : tuple
        Of those numbers.
    """

    conditions: tuple[str, ...]
    given: Floats
    participants: NDArray[np.intp]
    segments: NDArray[np.intp]
    participant_names: tuple[str, ...]
    segment_names: tuple[str, ...]

    @cached_property
    def better(self) -> Floats:
        """How many conditions stand before each one, in its ranking; NaN where left out."""
        return self._compared(np.less)

    @cached_property
    def tied(self) -> Floats:
        """How many conditions stand at its place, itself included; NaN where left out."""
        return self._compared(np.equal)

    @cached_property
    def ranks(self) -> Floats:
        """Ranks from 1; tied conditions share the mean of their places. NaN where left out."""
        return self.better + (self.tied + 1) / 2

    @cached_property
    def complete(self) -> NDArray[np.bool_]:
        """Which rankings place every condition."""
        return np.asarray(~np.isnan(self.given).any(axis=1))

    def averaged(self) -> Placements:
        """Return one ranking of each participant and segment, by the mean of their ranks."""
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
    """Arrange the ranks that one question was answered with.

    Parameters
    ----------
    answers : DataFrame
        Columns `participant`, `segment`, `condition` and `rank` (1 is best, equal numbers are a
        tie), one row per placed condition; `trial`, where somebody ranked a segment repeatedly.
    conditions : sequence of str
        All of them, in the order wanted.

    Raises
    ------
    InputError
        If a ranking places a condition twice.
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
    if pd.Series(rows * len(conditions) + columns).duplicated().any():
        raise InputError(
            "a participant placed a condition twice in one ranking",
            remedy="Summarise one question and one set at a time",
        )
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
    """Where one condition is placed.

    Attributes
    ----------
    condition : str
        Its name.
    n : int
        Rankings that place it.
    mean_rank : Estimate
        Mean rank, 1 is best, tied conditions sharing the mean of their places; tested against
        the middle rank.
    first_share : Estimate
        Share of the rankings in which it is best, conditions tied for it sharing one ranking;
        tested against what chance would give each.
    rank_percent : mapping of int to float
        Share of each place, in percent, ties spread evenly over their places; NaN without any.
    remark : str
        What limits the numbers; empty where nothing does.
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
    return RankSummary(
        condition=condition,
        n=n,
        mean_rank=clustered_mean(
            rankings.ranks[placed, column],
            participants,
            segments,
            null=(count + 1) / 2,
            limits=(1, count),
        ),
        first_share=clustered_mean(shares[:, 0], participants, segments, null=1 / count),
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
