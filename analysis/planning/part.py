"""The parts of a study that are simulated: its trials, opinions and tests, for any size."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

Codes = NDArray[np.intp]

Kind = Literal["pairs", "ratings", "rankings"]

THRESHOLDS: Final = (0.45, 1.6)
"""Thresholds of a latent difference from which answers are slight, and clear."""

RATING_THRESHOLDS: Final = (-1.6, -0.45, 0.45, 1.6)
"""Between five ratings on the latent scale."""

PARTICIPANT_SD: Final = 0.6
ITEM_SD: Final = 0.45
"""How much the difference of two conditions varies where nobody has measured it, in logits."""


@dataclass(frozen=True, kw_only=True)
class Opinions:
    """How people answer: assumed, or estimated from a pilot.

    Attributes
    ----------
    participant_sd, item_sd : float
        Standard deviation, over participants and over items, of the difference between two
        conditions, in logits.
    slight, clear : float
        Thresholds, in logits, from which a latent difference, noise included, is answered as
        slight and as clear; ``0 < slight < clear``.
    """

    participant_sd: float = PARTICIPANT_SD
    item_sd: float = ITEM_SD
    slight: float = THRESHOLDS[0]
    clear: float = THRESHOLDS[1]


@dataclass(frozen=True, kw_only=True, eq=False)
class Trials:
    """The analysed trials of all participants who are not excluded.

    Attributes
    ----------
    participants, items : ndarray of int, shape (N,)
        Who judges which item, from 0.
    conditions : int
        How many are compared; number 0 is the one that differs from all others.
    left, right : ndarray of int, shape (N,), or None
        Of pairs, the conditions shown; None where every trial shows all conditions.
    """

    participants: Codes
    items: Codes
    conditions: int
    left: Codes | None = None
    right: Codes | None = None

    @property
    def pairs(self) -> tuple[tuple[int, int], ...]:
        """Every two conditions: what is tested."""
        return tuple(combinations(range(self.conditions), 2))

    @cached_property
    def analysed(self) -> int:
        """How many participants there are."""
        return len(np.unique(self.participants))

    @cached_property
    def shown_items(self) -> int:
        """How many items are judged by anybody."""
        return len(np.unique(self.items))

    def of_pair(self, a: int, b: int) -> NDArray[np.intp]:
        """Return the trials that show the conditions `a` and `b`."""
        if self.left is None or self.right is None:
            return np.arange(len(self.participants))
        low, high = np.minimum(self.left, self.right), np.maximum(self.left, self.right)
        return np.flatnonzero((low == a) & (high == b))


@dataclass(frozen=True, kw_only=True, eq=False)
class Part:
    """Blocks of tests that are alike: the comparisons and questions of one part of a study.

    Attributes
    ----------
    name : str
        Of the set, block or task; empty where a study has no parts.
    kind : {'pairs', 'ratings', 'rankings'}
        How conditions are judged.
    trials : Trials
        Of one block.
    levels : int
        Points of the scale; of pairs 2, 3 or 5.
    blocks : int
        How many blocks the report tests: one for each comparison with participants or motions of
        its own, and each question.
    family : str
        Parts of one family are corrected together by Holm's method.
    """

    name: str
    kind: Kind
    trials: Trials
    levels: int
    blocks: int
    family: str

    @property
    def tests(self) -> int:
        """Tests of this part in the whole report."""
        return self.blocks * len(self.trials.pairs)


@dataclass(frozen=True, kw_only=True, eq=False)
class Size:
    """A study of one size.

    Attributes
    ----------
    participants : int
        Places of each comparison that has participants of its own; else of the study.
    items : int
        Segments.
    recruited : int
        Places of the whole study.
    analysed : int
        Of `participants`, those who are expected not to be excluded.
    trials : int
        Analysed trials of each participant.
    parts : tuple of Part
        What is simulated.
    """

    participants: int
    items: int
    recruited: int
    analysed: int
    trials: int
    parts: tuple[Part, ...]

    @property
    def numbers(self) -> tuple[int, int]:
        """Participants and items, which tell the sizes of a plan apart."""
        return self.participants, self.items


def count_analysed(participants: int, excluded: float) -> int:
    """Return how many of so many participants are analysed where a share is excluded."""
    return participants - int(participants * excluded + 0.5)
