"""How far participants agree about what they answered about."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.agreement.krippendorff import krippendorff_alpha

LEVEL: Final = "ordinal"


@dataclass(frozen=True, kw_only=True)
class Agreement:
    """Krippendorff's alpha for ordered answers; not a condition for anything.

    Attributes
    ----------
    alpha, low, high : float
        With its 95 % interval over items.
    n, items, participants : int
        Answers, items and participants that it rests on.
    method, reason : str
        How the interval was found; why a number is missing.
    """

    alpha: float
    low: float
    high: float
    n: int
    items: int
    participants: int
    method: str
    reason: str


def agreement_of(
    values: NDArray[np.number], participants: NDArray[np.intp], items: NDArray[np.intp]
) -> Agreement:
    """Return ordinal alpha; of several answers of one participant about an item, the first."""
    # A key of both, so that one pass finds who answered twice.
    key = participants.astype(np.int64) * (int(items.max(initial=0)) + 1) + items
    first = np.sort(np.unique(key, return_index=True)[1])
    found = krippendorff_alpha(values[first], participants[first], items[first], level=LEVEL)
    return Agreement(
        alpha=found.estimate,
        low=found.low,
        high=found.high,
        n=found.answers,
        items=found.items,
        participants=found.raters,
        method=found.method,
        reason=found.reason,
    )
