"""How much better one condition is rated than another: a test, and a model that describes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np
import pandas as pd

from analysis.results.grouping import Family, PairPlace, codes
from analysis.stats.clustered_mean import Estimate
from analysis.stats.ordinal.mixed_model import RandomEffect, fit
from analysis.stats.ratings import (
    RatedCells,
    cliffs_delta,
    mean_differences,
    rated_cells,
)
from motion.errors import InputError

MOST_SCORES: Final = 21
"""Different ratings up to which they are taken for ordered categories."""


@dataclass(frozen=True, kw_only=True)
class RatingModel:
    """The model ``rating ~ condition + (1 | participant) + (1 | segment)``, in logits.

    It takes conditions to differ alike for all participants and segments. Where they do not, its
    errors are too small, so that it gives none: the differences of paired ratings test.

    Attributes
    ----------
    reference : str
        The condition whose effect is zero.
    estimates : mapping of condition to float
        Above zero where a condition is rated better than the reference.
    log_likelihood : float
        By Laplace's approximation.
    sd_participant, sd_segment : float
        How much ratings differ between participants and between segments.
    thresholds : tuple of float
        Between neighbouring scores of `scores_given`.
    scores_given : tuple of int
        The scores that somebody gave.
    n : int
        Ratings.
    remark, reason : str
        What limits the result; why there is none.
    """

    reference: str = ""
    estimates: Mapping[str, float]
    log_likelihood: float = math.nan
    sd_participant: float = math.nan
    sd_segment: float = math.nan
    thresholds: tuple[float, ...] = ()
    scores_given: tuple[int, ...] = ()
    n: int
    remark: str = ""
    reason: str = ""


def rating_model(answers: pd.DataFrame, shown: tuple[str, ...]) -> RatingModel:
    """Fit the ratings of one question.

    Parameters
    ----------
    answers : DataFrame
        Main and repeated trials.
    shown : tuple of str
        Conditions that were rated; the first is the reference.
    """
    ratings = answers["value"].to_numpy().astype(np.int64)
    scores = tuple(np.unique(ratings).tolist())
    names = answers["condition"].to_numpy(object)
    unknown = RatingModel(
        reference=shown[0],
        estimates=dict.fromkeys(shown, math.nan),
        scores_given=scores,
        n=len(ratings),
    )
    random = [
        RandomEffect(name=name, groups=codes(answers, name)) for name in ("participant", "segment")
    ]
    reason = _why_no_model(shown, scores, random)
    if reason:
        return replace(unknown, reason=reason)
    covariates = {name: (names == name).astype(np.float64) for name in shown[1:]}
    try:
        found = fit(ratings, covariates, random)
    except InputError as error:
        return replace(unknown, reason=error.what)
    if not found.converged:
        return replace(unknown, reason=found.remark)
    return replace(
        unknown,
        estimates={shown[0]: 0.0, **found.estimates},
        log_likelihood=found.log_likelihood,
        sd_participant=found.deviations["participant"],
        sd_segment=found.deviations["segment"],
        thresholds=found.thresholds,
        remark=found.remark,
    )


def _why_no_model(
    shown: tuple[str, ...], scores: tuple[int, ...], random: list[RandomEffect]
) -> str:
    if len(shown) < 2:
        return "one condition"
    for effect in random:
        if len(np.unique(effect.groups)) < 2:
            return f"one {effect.name}"
    if len(scores) < 2:
        return "all ratings alike"
    if len(scores) > MOST_SCORES:
        return (
            f"{len(scores)} different ratings are no ordered categories; means and Cliff's delta "
            "stand"
        )
    return ""


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
