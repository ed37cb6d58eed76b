"""Pairwise preferences as numbers, and how often each was given."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]

PART: Final = 32_768
"""Answers counted at a time: as many as stay near the processor."""

ROOM: Final = 8
"""Kinds of answers of all participants, for each answer, up to which all are counted out."""


@dataclass(frozen=True, kw_only=True)
class Votes:
    """Pairwise preferences as numbers, one row for each answer.

    Attributes
    ----------
    conditions : tuple of str
        Names of all conditions.
    left, right : ndarray of int, shape (N,)
        Which conditions were shown on the left and on the right.
    outcome : ndarray of int, shape (N,)
        1 where the left one was preferred, 0 for a tie, -1 where the right one was.
    participant : ndarray of int, shape (N,)
        Who answered, from 0.
    segment : ndarray of int, shape (N,), or None
        Which segment it is about, from 0; None where that is not known.
    """

    conditions: tuple[str, ...]
    left: Codes
    right: Codes
    outcome: Codes
    participant: Codes
    segment: Codes | None = None

    def __post_init__(self) -> None:
        """Refuse a pair of a condition with itself."""
        if (self.left == self.right).any():
            raise InputError("an answer compares a condition with itself")

    @cached_property
    def tallies(self) -> tuple[Codes, Codes, Codes]:
        """Who answered what how often: participants, kinds of answers and numbers of them.

        A kind is 3 (left * conditions + right) + 1 - outcome. Where participants are too many to
        count out all that each could have answered, every answer stands for itself.
        """
        count = len(self.conditions)
        kinds, people = 3 * count**2, int(self.participant.max(initial=-1)) + 1
        cells = np.empty(len(self.participant), np.intp)
        # Part by part and in place: a million answers are counted as fast as they can be read.
        for start in range(0, len(cells), PART):
            part = slice(start, start + PART)
            own = cells[part]
            np.multiply(self.participant[part], count, out=own)
            own += self.left[part]
            own *= count
            own += self.right[part]
            own *= 3
            own -= self.outcome[part]
            own += 1
        if people * kinds > ROOM * len(cells):
            return cells // kinds, cells % kinds, np.ones(len(cells), np.intp)
        counted = np.bincount(cells, minlength=people * kinds)
        filled = np.flatnonzero(counted)
        return filled // kinds, filled % kinds, counted[filled]

    @cached_property
    def table(self) -> Floats:
        """How often left won, nobody did and right won, shape (left, right, 3)."""
        count = len(self.conditions)
        _, kinds, times = self.tallies
        found = np.bincount(kinds, weights=times, minlength=3 * count**2)
        return np.asarray(found, np.float64).reshape(count, count, 3)

    @property
    def beats(self) -> Floats:
        """How often each condition was preferred to each other one; ties count for both."""
        left, tie, right = np.moveaxis(self.table, 2, 0)
        return np.asarray(left + tie + (right + tie).T)

    @property
    def participants(self) -> int:
        """How many have answered."""
        return int(np.count_nonzero(np.bincount(self.tallies[0])))
