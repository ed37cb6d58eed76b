"""Answers to one question as sums by participant, by what was shown, and by segment.

They are all that resampling needs, and it costs no more for a million answers than for thousands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import sparse

from analysis.results.grouping import codes
from analysis.stats.two_way_bootstrap import FULL, Table

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]

PREFERENCE: Final = {
    "pairwise": "Bradley–Terry strength in logits, ties counting one half, adding up to zero",
    "rating": "mean rating",
    "ranking": "minus the mean rank",
    "mismatch": "win share of the own speech, ties counting one half",
}
"""What stands for people's preference of a condition, by protocol."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Tallies:
    """Answers to one question.

    Attributes
    ----------
    conditions, segments : tuple of str
        Those that were shown.
    groups : ndarray of int, shape (G, 1) or (G, 2)
        What an answer is about: a condition, or of pairwise comparisons a pair of them, of which
        the answer is a win of the first.
    sums, counts : array or sparse array, shape (participants, G * segments)
        Sum and number of answers; columns by group, then segment.
    """

    conditions: tuple[str, ...]
    segments: tuple[str, ...]
    groups: Codes
    sums: Table
    counts: Table

    @property
    def participants(self) -> int:
        """How many answered."""
        return int(self.counts.shape[0])

    @property
    def cells(self) -> tuple[Floats, Floats]:
        """Sums and counts over all participants, shape (G, segments)."""
        shape = (len(self.groups), len(self.segments))
        sums, counts = (
            np.asarray(table.sum(axis=0), np.float64).reshape(shape)
            for table in (self.sums, self.counts)
        )
        return sums, counts


def tallies(protocol: str, answers: pd.DataFrame) -> Tallies:
    """Sum up the answers to one question.

    Parameters
    ----------
    protocol : {'pairwise', 'rating', 'ranking', 'mismatch'}
        How they were asked for.
    answers : DataFrame
        Analysed answers of `analysis.answers.table.AnswerTable`, at least one.
    """
    values, shown = _values(protocol, answers)
    named = answers["left" if protocol == "pairwise" else "condition"].cat.categories
    known, shown = np.unique(shown, return_inverse=True)
    shown = shown.reshape(len(answers), -1)
    groups, group = np.unique(shown, axis=0, return_inverse=True)
    people, who = np.unique(codes(answers, "participant"), return_inverse=True)
    things, what = np.unique(codes(answers, "segment"), return_inverse=True)
    column = group.ravel() * len(things) + what
    shape = (len(people), len(groups) * len(things))

    def table(numbers: Floats) -> Table:
        found = sparse.coo_array((numbers, (who, column)), shape=shape).tocsr()
        return found if found.nnz < FULL * shape[0] * shape[1] else found.toarray()

    return Tallies(
        conditions=tuple(str(named[place]) for place in known),
        segments=tuple(str(answers["segment"].cat.categories[place]) for place in things),
        groups=groups.astype(np.intp),
        sums=table(values),
        counts=table(np.ones(len(values))),
    )


def _values(protocol: str, answers: pd.DataFrame) -> tuple[Floats, Codes]:
    """Return what each answer says for what was shown, and the one or two that were."""
    given = answers["value"].to_numpy(np.float64)
    if protocol == "pairwise":
        left, right = codes(answers, "left"), codes(answers, "right")
        towards_right = np.sign(given - 3)
        wins = (np.where(right < left, towards_right, -towards_right) + 1) / 2
        return wins, np.stack([np.minimum(left, right), np.maximum(left, right)], axis=1)
    shown = codes(answers, "condition")
    if protocol == "mismatch":
        own_on_right = answers["right_speech"].to_numpy(object) == "own"
        return (np.where(own_on_right, 1, -1) * np.sign(given - 3) + 1) / 2, shown
    if protocol == "ranking":
        return -_ranks(answers), shown
    return given, shown


def _ranks(answers: pd.DataFrame) -> Floats:
    """Return the rank of each placed condition in its ranking, ties sharing theirs."""
    rankings = [codes(answers, "participant"), codes(answers, "segment")]
    given = pd.Series(answers["value"].to_numpy(np.float64))
    return given.groupby(rankings).rank(method="average").to_numpy(np.float64)
