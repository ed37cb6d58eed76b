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
        there = ~np.isnan(self.given)
        sums, counts = np.zeros((2, len(cells), len(self.conditions)))
        np.add.at(sums, cell, np.where(there, self.ranks, 0.0))
        np.add.at(counts, cell, there)
        with np.errstate(invalid="ignore"):
            means = sums / counts
        return replace(self, given=means, participants=cells[:, 0], segments=cells[:, 1])

    def _compared(self, how: np.ufunc) -> Floats:
        found = np.zeros_like(self.given)
        for other in range(len(self.conditions)):
            found += how(self.given[:, [other]], self.given)
        found[np.isnan(self.given)] = np.nan
        return found


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
    columns = condition_columns(answers["condition"], conditions)
    own = columns >= 0
    people, participant_names = pd.factorize(answers["participant"][own])
    things, segment_names = pd.factorize(answers["segment"][own])
    trials = pd.factorize(answers["trial"][own])[0] if "trial" in answers else np.zeros_like(people)
    named = np.column_stack([people, things, trials])
    cells, rows = np.unique(named, axis=0, return_inverse=True)
    rows = rows.ravel()
    given = np.full((len(cells), len(conditions)), np.nan)
    if pd.Series(rows * len(conditions) + columns[own]).duplicated().any():
        raise InputError(
            "a participant placed a condition twice in one ranking",
            remedy="Summarise one question and one set at a time",
        )
    given[rows, columns[own]] = answers["rank"].to_numpy(np.float64)[own]
    return Placements(
        conditions=tuple(conditions),
        given=given,
        participants=cells[:, 0],
        segments=cells[:, 1],
        participant_names=tuple(map(str, participant_names)),
        segment_names=tuple(map(str, segment_names)),
    )


def condition_columns(names: pd.Series[str], conditions: Sequence[str]) -> NDArray[np.intp]:
    """Return the place of each name among `conditions`, -1 for those that are not there."""
    codes, kinds = pd.factorize(names)
    place = {condition: number for number, condition in enumerate(conditions)}
    return np.array([place.get(kind, -1) for kind in kinds], np.intp)[codes]


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
    places = len(rankings.conditions)
    there = ~np.isnan(rankings.given[:, column])
    better, tied = rankings.better[there, column], rankings.tied[there, column]
    who, what = rankings.participants[there], rankings.segments[there]
    place = np.arange(1, places + 1)
    held = ((better[:, None] < place) & (place <= (better + tied)[:, None])) / tied[:, None]
    count = int(there.sum())
    percent = (100 * held.mean(axis=0)).tolist() if count else [math.nan] * places
    partial = int((there & ~rankings.complete).sum())
    return RankSummary(
        condition=condition,
        n=count,
        mean_rank=clustered_mean(
            rankings.ranks[there, column], who, what, null=(places + 1) / 2, limits=(1, places)
        ),
        first_share=clustered_mean(held[:, 0], who, what, null=1 / places),
        rank_percent=dict(enumerate(percent, start=1)),
        remark=f"{partial} of {count} rankings leave conditions out" if partial else "",
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
