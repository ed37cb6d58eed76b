"""How much better one condition is rated than another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import pandas as pd

from analysis.results.family import Family
from analysis.results.grouping import PairPlace, codes
from analysis.results.rating_model import RatingModel
from analysis.stats.clustered_mean import Estimate
from analysis.stats.ratings import (
    RatedCells,
    cliffs_delta,
    mean_differences,
    rated_cells,
)


@dataclass(frozen=True, kw_only=True)
class RatedDifference(Estimate):
    """How much better a is rated than b, in scores: the headline.

    Attributes
    ----------
    p_holm : float
        `p_value`, corrected over the report's family; NaN outside of it.
    """

    p_holm: float = math.nan


@dataclass(frozen=True, kw_only=True)
class RatingContrast(PairPlace):
    """How much better a is rated than b.

    Attributes
    ----------
    difference : RatedDifference
        Mean difference of paired ratings; the headline.
    log_odds, odds_ratio : float
        Of a better rating for a than for b in the mixed model, which describes and does not test.
    cliffs_delta : Estimate
        How far the ratings lie apart.
    remark : str
        Why there are no log-odds, or what limits them.
    """

    difference: RatedDifference
    log_odds: float
    odds_ratio: float
    cliffs_delta: Estimate
    remark: str


def rating_contrasts(
    of: str | None,
    question: str,
    answers: pd.DataFrame,
    shown: tuple[str, ...],
    model: RatingModel,
) -> list[RatingContrast]:
    """Compare every two conditions; where there is no model, by what can be said without it.

    Parameters
    ----------
    of, question : str or None, str
        The set and the question.
    answers : DataFrame
        Main and repeated trials.
    shown : tuple of str
        Conditions that were rated, in order.
    model : RatingModel
        Of the same ratings.
    """
    differences = _differences(answers, shown)
    return [
        RatingContrast(
            set=of,
            a=a,
            b=b,
            question=question,
            difference=differences[a, b],
            log_odds=(log_odds := model.estimates[a] - model.estimates[b]),
            odds_ratio=math.exp(log_odds),
            cliffs_delta=_dominance(answers, a, b),
            remark=model.reason or model.remark,
        )
        for a, b in combinations(shown, 2)
    ]


def with_holm(found: Sequence[RatingContrast], family: Family) -> tuple[RatingContrast, ...]:
    """Return the contrasts of a report, their tests corrected over its family."""
    corrected = family.corrected(found, [one.difference.p_value for one in found])
    return tuple(
        replace(one, difference=replace(one.difference, p_holm=p))
        for one, p in zip(found, corrected, strict=True)
    )


def rated_cells_of(answers: pd.DataFrame, count: int) -> RatedCells:
    """Arrange the ratings of one question by participant and segment.

    Parameters
    ----------
    answers : DataFrame
        Main and repeated trials.
    count : int
        How many conditions were rated.
    """
    return rated_cells(
        answers["value"].to_numpy(np.float64),
        np.unique(codes(answers, "condition"), return_inverse=True)[1].astype(np.intp),
        codes(answers, "participant"),
        codes(answers, "segment"),
        count=count,
    )


def _differences(
    answers: pd.DataFrame, shown: tuple[str, ...]
) -> dict[tuple[str, str], RatedDifference]:
    cells = rated_cells_of(answers, len(shown))
    return {
        (shown[a], shown[b]): RatedDifference(**vars(found))
        for (a, b), found in mean_differences(cells).items()
    }


def _dominance(answers: pd.DataFrame, a: str, b: str) -> Estimate:
    names = answers["condition"].to_numpy(object)
    two = answers[(names == a) | (names == b)]
    return cliffs_delta(
        two["value"].to_numpy(np.float64),
        two["condition"].to_numpy(object) == a,
        codes(two, "participant"),
        codes(two, "segment"),
    )
