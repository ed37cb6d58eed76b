"""Answers for or against something that was shown on one of two sides."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.results.grouping import codes

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


@dataclass(frozen=True, kw_only=True, eq=False)
class SidedAnswers:
    """Answers to one question about one comparison.

    Attributes
    ----------
    responses : ndarray of int, shape (N,)
        1 (strongly left) … 5 (strongly right).
    on_right : ndarray of bool, shape (N,)
        Whether what is asked about was shown on the right.
    participants, segments : ndarray of int, shape (N,)
        Who answered about what.
    """

    responses: NDArray[np.int64]
    on_right: NDArray[np.bool_]
    participants: Codes
    segments: Codes

    @property
    def towards(self) -> NDArray[np.int64]:
        """-2 (strongly against) … 2 (strongly for)."""
        return np.where(self.on_right, self.responses - 3, 3 - self.responses)

    @property
    def wins(self) -> Floats:
        """1 for a preference for it, 0 for one against it, one half for a tie."""
        return np.asarray((np.sign(self.towards) + 1) / 2, np.float64)


def sided(answers: pd.DataFrame, on_right: NDArray[np.bool_]) -> SidedAnswers:
    """Return answers as arrays."""
    return SidedAnswers(
        responses=answers["value"].to_numpy().astype(np.int64),
        on_right=on_right,
        participants=codes(answers, "participant"),
        segments=codes(answers, "segment"),
    )
