"""What a protocol's table has besides the columns of every table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.columns import Column

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
