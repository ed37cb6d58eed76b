"""How uncertain strengths are: their intervals, and the ranks that conditions may have."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.preferences.clustered import LEVEL
from analysis.strengths.rank_intervals import errors_of_differences, rank_intervals
from analysis.strengths.two_way import TwoWayErrors, deviations

Floats = NDArray[np.float64]

ONE_SEGMENT: Final = "one segment: intervals and ranks take it as the only one of interest"

BY_PARTICIPANT: Final = "clustered by participant"


@dataclass(frozen=True, kw_only=True)
class RankInterval:
    """The best and the worst rank that a condition may have, from 1."""

    best: int
    worst: int


@dataclass(frozen=True, kw_only=True)
class StrengthErrors:
    """What the strengths of conditions may be.

    Attributes
    ----------
    errors_two_way : mapping of condition to float
        Clustered by participant and segment; NaN where there is one of either.
    low, high : mapping of condition to float
        Ends of each strength's 95 % interval.
    ranks : mapping of condition to RankInterval
        At 95 %, all together; empty where nothing is known.
    method : str
        Which errors intervals and ranks rest on; empty where there are none.
    """

    errors_two_way: Mapping[str, float]
    low: Mapping[str, float]
    high: Mapping[str, float]
    ranks: Mapping[str, RankInterval]
    method: str


def strength_errors(
    names: tuple[str, ...],
    strengths: Floats,
    clustered: Floats,
    two_way: TwoWayErrors | None,
    *,
    participants: int,
    known: bool,
) -> StrengthErrors:
    """Return intervals and ranks from two-way errors, or from those by participant.

    Parameters
    ----------
    names : tuple of str, K of them
        Of the conditions.
    strengths, clustered : ndarray, shape (K,), (K, K)
        Estimates and their covariance clustered by participant.
    two_way : TwoWayErrors or None
        Errors that also take segments as a sample; None where there are none.
    participants : int
        How many there are.
    known : bool
        Whether there are strengths.
    """
    none = dict.fromkeys(names, math.nan)
    if participants < 2 or not known:
        return StrengthErrors(errors_two_way=none, low=none, high=none, ranks={}, method="")
    if two_way is None:
        errors, differences = deviations(clustered), errors_of_differences(clustered)
        freedom, method = participants - 1, BY_PARTICIPANT
    else:
        errors, differences = two_way.errors, two_way.differences
        freedom, method = two_way.freedom, two_way.method
    reach = float(stats.t(freedom).ppf((1 + LEVEL) / 2)) * errors
    ranks = rank_intervals(strengths, differences, level=LEVEL, freedom=freedom)
    return StrengthErrors(
        errors_two_way=none if two_way is None else _named(names, errors),
        low=_named(names, strengths - reach),
        high=_named(names, strengths + reach),
        ranks={
            name: RankInterval(best=best, worst=worst)
            for name, (best, worst) in zip(names, ranks, strict=True)
        },
        method=f"{method}; t with {freedom} degree{'s' * (freedom > 1)} of freedom",
    )


def _named(names: tuple[str, ...], values: Floats) -> dict[str, float]:
    return dict(zip(names, values.tolist(), strict=True))
