"""How much better one condition is rated than another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import pandas as pd

from analysis.holm import holm
from analysis.ordinal.mixed_model import OrdinalFit
from analysis.ratings.cliffs_delta import cliffs_delta
from analysis.ratings.contrasts import Contrast, contrasts
from analysis.ratings.differences import RatedCells, mean_differences, rated_cells
from analysis.results.estimate import Estimate, estimate_of
from analysis.results.grouping import codes
from analysis.results.place import PairPlace
from analysis.results.rating_model import RatingModel


@dataclass(frozen=True, kw_only=True)
class Dominance:
    """Cliff's delta: how often a is rated higher minus how often lower, in [-1, 1].

    Attributes
    ----------
    estimate, low, high, se : float
        With its clustered 95 % interval; NaN where there is none.
    n, participants, segments : int
        Ratings of both conditions, and who gave them about what.
    method, reason : str
        Which variance was used; why a number is missing.
    """

    estimate: float
    low: float
    high: float
    se: float
    n: int
    participants: int
    segments: int
    method: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class RatedDifference(Estimate):
    """How much better a is rated than b, in scores: the headline.

    Attributes
    ----------
    p_holm : float
        `p`, corrected over all contrasts and questions of the report.
    """

    p_holm: float = math.nan


@dataclass(frozen=True, kw_only=True)
class RatingContrast(PairPlace):
    """How much better a is rated than b.

    Attributes
    ----------
    difference : RatedDifference
        Mean difference of paired ratings; the headline.
    estimate, se, low, high : float
        Difference in logits in the mixed model, with its 95 % interval. The model takes
        conditions to differ alike for all participants and segments.
    z, p : float
        Its test.
    p_holm : float
        That p, corrected over all contrasts and questions of the report.
    odds_ratio, odds_low, odds_high : float
        Odds of a better rating for a over those for b.
    cliffs_delta : Dominance
        How far the ratings lie apart.
    remark : str
        Why there is no difference, or what limits it.
    """

    difference: RatedDifference
    estimate: float
    se: float
    low: float
    high: float
    z: float
    p: float
    p_holm: float
    odds_ratio: float
    odds_low: float
    odds_high: float
    cliffs_delta: Dominance
    remark: str


def rating_contrasts(
    of: str | None,
    question: str,
    answers: pd.DataFrame,
    shown: tuple[str, ...],
    fitted: OrdinalFit | None,
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
    fitted, model
        See `rating_model`.
    """
    of_model = {(c.a, c.b): c for c in contrasts(fitted, shown)} if fitted is not None else {}
    differences = _differences(answers, shown)
    found = []
    for a, b in combinations(shown, 2):
        delta = _dominance(answers, a, b)
        contrast = of_model.get((a, b)) or _unknown(a, b, model)
        found.append(
            RatingContrast(
                set=of,
                a=a,
                b=b,
                question=question,
                difference=differences[a, b],
                estimate=contrast.estimate,
                se=contrast.standard_error,
                low=contrast.low,
                high=contrast.high,
                z=contrast.statistic,
                p=contrast.p_value,
                p_holm=math.nan,
                odds_ratio=contrast.odds_ratio,
                odds_low=contrast.odds_low,
                odds_high=contrast.odds_high,
                cliffs_delta=delta,
                remark=contrast.remark,
            )
        )
    return found


def with_holm(found: Sequence[RatingContrast]) -> tuple[RatingContrast, ...]:
    """Return the contrasts of a report, their tests corrected over all of them."""
    of_scores = holm([one.difference.p for one in found])
    of_model = holm([one.p for one in found])
    return tuple(
        replace(one, difference=replace(one.difference, p_holm=p), p_holm=q)
        for one, p, q in zip(found, of_scores, of_model, strict=True)
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
        (shown[a], shown[b]): RatedDifference(**vars(estimate_of(found)))
        for (a, b), found in mean_differences(cells).items()
    }


def _unknown(a: str, b: str, model: RatingModel) -> Contrast:
    none = math.nan
    return Contrast(
        a=a,
        b=b,
        estimate=none,
        standard_error=none,
        low=none,
        high=none,
        statistic=none,
        p_value=none,
        holm_p=none,
        odds_ratio=none,
        odds_low=none,
        odds_high=none,
        answers=model.n,
        remark=model.reason,
    )


def _dominance(answers: pd.DataFrame, a: str, b: str) -> Dominance:
    names = answers["condition"].to_numpy(object)
    two = answers[(names == a) | (names == b)]
    found = cliffs_delta(
        two["value"].to_numpy(np.float64),
        two["condition"].to_numpy(object) == a,
        codes(two, "participant"),
        codes(two, "segment"),
    )
    return Dominance(
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        se=found.standard_error,
        n=found.first + found.second,
        participants=found.participants,
        segments=found.segments,
        method=found.method,
        reason=found.reason,
    )
