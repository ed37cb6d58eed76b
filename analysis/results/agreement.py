"""How far participants agree about what they answered about."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.stats.intraclass import Intraclass, intraclass_correlation
from analysis.stats.krippendorff import krippendorff_alpha

LEVEL: Final = "ordinal"


@dataclass(frozen=True, kw_only=True)
class IntraclassCorrelation:
    """How much of the answers' variance lies between items, as numbers equally far apart.

    Attributes
    ----------
    single, single_low, single_high : float
        Of one participant's answers, ICC(A,1), with its 95 % interval.
    average, average_low, average_high : float
        Of the mean over the participants of an item, ICC(A,k).
    participants_per_item : float
        Harmonic mean: the k of the average.
    method, reason : str
        Which correlation; why there is none.
    """

    single: float
    single_low: float
    single_high: float
    average: float
    average_low: float
    average_high: float
    participants_per_item: float
    method: str
    reason: str


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
    icc : IntraclassCorrelation
        The same question asked of variances.
    """

    alpha: float
    low: float
    high: float
    n: int
    items: int
    participants: int
    method: str
    reason: str
    icc: IntraclassCorrelation


def agreement_of(
    values: NDArray[np.number], participants: NDArray[np.intp], items: NDArray[np.intp]
) -> Agreement:
    """Return ordinal alpha and the ICC; of several answers about an item, a participant's first."""
    # A key of both, so that one pass finds who answered twice.
    key = participants.astype(np.int64) * (int(items.max(initial=0)) + 1) + items
    first = np.sort(np.unique(key, return_index=True)[1])
    own = values[first], participants[first], items[first]
    found = krippendorff_alpha(*own, level=LEVEL)
    return Agreement(
        alpha=found.estimate,
        low=found.low,
        high=found.high,
        n=found.answers,
        items=found.items,
        participants=found.raters,
        method=found.method,
        reason=found.reason,
        icc=_icc(intraclass_correlation(*own)),
    )


def _icc(found: Intraclass) -> IntraclassCorrelation:
    return IntraclassCorrelation(
        single=found.single.estimate,
        single_low=found.single.low,
        single_high=found.single.high,
        average=found.average.estimate,
        average_low=found.average.low,
        average_high=found.average.high,
        participants_per_item=found.raters_per_item,
        method=found.method,
        reason=found.reason,
    )
