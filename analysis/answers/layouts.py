"""What the four protocols' tables have besides the columns of every table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.columns import PREFERENCE, RANK, RATING, Column, name_column, speech_column

Rows = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class Layout:
    """The columns of one protocol.

    Attributes
    ----------
    protocol : str
        Its name.
    conditions : tuple of Column
        Columns that name conditions, from left to right.
    value : Column
        The answer.
    others : tuple of Column
        What else tells what was shown.
    has_sides : bool
        Whether two videos stand side by side, so that a catch trial has a correct side.
    answered_once : bool
        Whether a participant answers one question about a segment's condition once, so that
        rows need no trial to belong together.
    wrong : callable
        From the answers of main and repeated trials, which rows contradict themselves.
    contradiction : str
        What is wrong with such a row.
    """

    protocol: str
    conditions: tuple[Column, ...]
    value: Column
    others: tuple[Column, ...] = ()
    has_sides: bool
    answered_once: bool = False
    wrong: Callable[[pd.DataFrame], Rows]
    contradiction: str = ""

    @property
    def columns(self) -> tuple[Column, ...]:
        """All of them."""
        return (*self.conditions, *self.others, self.value)


def nothing_wrong(answers: pd.DataFrame) -> Rows:
    """Find no row that contradicts itself."""
    return np.zeros(len(answers), bool)


def _same(answers: pd.DataFrame, left: str, right: str) -> Rows:
    return np.asarray(answers[left].astype(object) == answers[right].astype(object), bool)


PAIRWISE: Final = Layout(
    protocol="pairwise",
    conditions=(name_column("left"), name_column("right")),
    value=PREFERENCE,
    has_sides=True,
    wrong=lambda answers: _same(answers, "left", "right"),
    contradiction="left and right are the same condition",
)

RATING_OF_ONE: Final = Layout(
    protocol="rating",
    conditions=(name_column("condition"),),
    value=RATING,
    has_sides=False,
    wrong=nothing_wrong,
)

RANKING: Final = Layout(
    protocol="ranking",
    conditions=(name_column("condition"),),
    value=RANK,
    has_sides=False,
    answered_once=True,
    wrong=nothing_wrong,
)

MISMATCH: Final = Layout(
    protocol="mismatch",
    conditions=(name_column("condition"),),
    value=PREFERENCE,
    others=(speech_column("left_speech"), speech_column("right_speech")),
    has_sides=True,
    wrong=lambda answers: _same(answers, "left_speech", "right_speech"),
    contradiction="left_speech and right_speech are the same; one is own, the other is other",
)

LAYOUTS: Final[Mapping[str, Layout]] = MappingProxyType(
    {layout.protocol: layout for layout in (PAIRWISE, RATING_OF_ONE, RANKING, MISMATCH)}
)
"""By the name that the command line takes."""
