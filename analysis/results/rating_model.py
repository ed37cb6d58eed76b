"""The cumulative link mixed model of ratings, which describes and does not test."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pandas as pd

from analysis.results.grouping import codes
from analysis.stats.ordinal.mixed_model import RandomEffect, fit
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
