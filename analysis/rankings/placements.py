"""Rankings as a table: one row for each ranking, one column for each condition."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray

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
        tie), one row per placed condition.
    conditions : sequence of str
        All of them, in the order wanted.

    Raises
    ------
    InputError
        If somebody placed a condition of a segment twice.
    """
    own = answers[answers["condition"].isin(list(conditions))]
    people, participant_names = pd.factorize(own["participant"])
    things, segment_names = pd.factorize(own["segment"])
    cells = people.astype(np.intp) * (len(segment_names) + 1) + things
    kinds, rows = np.unique(cells, return_inverse=True)
    columns = pd.Index(list(conditions)).get_indexer(pd.Index(own["condition"].to_numpy(object)))
    if len(np.unique(rows * len(conditions) + columns)) < len(own):
        raise InputError(
            "a participant placed a condition twice in one segment",
            remedy="Summarise one question and one set at a time",
        )
    given = np.full((len(kinds), len(conditions)), np.nan)
    given[rows, columns] = own["rank"].to_numpy(np.float64)
    return Placements(
        conditions=tuple(conditions),
        given=given,
        participants=kinds // (len(segment_names) + 1),
        segments=kinds % (len(segment_names) + 1),
        participant_names=tuple(map(str, participant_names)),
        segment_names=tuple(map(str, segment_names)),
    )
