"""Answers turned so that they speak about the reference condition, and counted.

The table that AMUSE prints (Chhatre et al. 2024, Table A.5) comes from these counts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from motion.errors import InputError

LEVEL_NAMES: Final = (
    "clearly reference",
    "slightly reference",
    "no difference",
    "slightly other",
    "clearly other",
)


@dataclass(frozen=True, kw_only=True)
class FiveLevelCounts:
    """How often each of the five answers was given, seen from the reference condition.

    Attributes
    ----------
    clearly_reference, slightly_reference, no_difference, slightly_other, clearly_other : int
        Number of answers.
    """

    clearly_reference: int
    slightly_reference: int
    no_difference: int
    slightly_other: int
    clearly_other: int

    @property
    def levels(self) -> tuple[int, int, int, int, int]:
        """The five counts in the order of `LEVEL_NAMES`."""
        return (
            self.clearly_reference,
            self.slightly_reference,
            self.no_difference,
            self.slightly_other,
            self.clearly_other,
        )

    @property
    def total(self) -> int:
        """Number of answers."""
        return sum(self.levels)

    @property
    def percentages(self) -> tuple[float, float, float, float, float]:
        """The five counts in percent of all answers; NaN without any."""
        if not self.total:
            return (float("nan"),) * 5
        first, second, third, fourth, fifth = (100 * n / self.total for n in self.levels)
        return first, second, third, fourth, fifth

    @property
    def ours(self) -> float:
        """AMUSE's 'ours': clear and slight preferences for the reference, % of all answers."""
        return sum(self.percentages[:2])

    @property
    def indifferent(self) -> float:
        """Answers 'no difference', % of all answers; AMUSE's table leaves them out."""
        return self.percentages[2]

    @property
    def others(self) -> float:
        """AMUSE's 'others': clear and slight preferences for the other, % of all answers."""
        return sum(self.percentages[3:])


def towards_reference(responses: pd.DataFrame) -> NDArray[np.int64]:
    """Return each answer as -2 (clearly the other) … 2 (clearly the reference).

    Parameters
    ----------
    responses : DataFrame
        Tidy main or repeat answers; `value` counts from left (-2) to right (2).

    Returns
    -------
    ndarray, shape (N,), int64
    """
    values = responses["value"].to_numpy(np.int64)
    on_right = (responses["right_condition"] == responses["reference"]).to_numpy(bool)
    on_left = (responses["left_condition"] == responses["reference"]).to_numpy(bool)
    if not np.all(on_left ^ on_right):
        raise InputError(
            "an answer was given to a pair that does not show the reference condition once",
            remedy="Analyse main and repeat trials only",
        )
    return np.where(on_right, values, -values)


def count_levels(oriented: NDArray[np.int64]) -> FiveLevelCounts:
    """Count answers that `towards_reference` has turned."""
    counts = np.bincount(2 - oriented, minlength=5).tolist()
    return FiveLevelCounts(
        clearly_reference=counts[0],
        slightly_reference=counts[1],
        no_difference=counts[2],
        slightly_other=counts[3],
        clearly_other=counts[4],
    )
