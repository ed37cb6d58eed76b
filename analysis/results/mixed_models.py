"""Cumulative link mixed models: of preferences as given, left to right, and of ratings."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pandas as pd

from analysis.results.grouping import codes, is_on_right, shown_conditions
from analysis.stats.ordinal.mixed_model import RandomEffect, fit, likelihood_ratio
from motion.arrays import Bools, Floats, Indices, Ints

SEPARATED: Final = (
    "the answers are separated: all prefer the same side, so the log-odds have no finite estimate"
)

ONE_SIDE: Final = (
    "always shown on the same side: a preference for it cannot be distinguished from one for the "
    "side"
)


MOST_SCORES: Final = 21
"""Ratings with more distinct values are not modelled as ordered categories."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SidedAnswers:
    """Answers to one question about one comparison.

    Attributes
    ----------
    responses : ndarray of int, shape (N,)
        1 (strongly left) … 5 (strongly right).
    on_right : ndarray of bool, shape (N,)
        Whether the first side, whose preference is measured, was shown on the right.
    participants, segments : ndarray of int, shape (N,)
        The participant and the segment of each answer.
    """

    responses: Ints
    on_right: Bools
    participants: Indices
    segments: Indices

    @property
    def signed(self) -> Ints:
        """-2 (strongly against) … 2 (strongly for the first side)."""
        return np.where(self.on_right, self.responses - 3, 3 - self.responses)

    @property
    def wins(self) -> Floats:
        """1 for a preference for the first side, 0 for one against it, one half for a tie."""
        return np.asarray((np.sign(self.signed) + 1) / 2, np.float64)


def sided(answers: pd.DataFrame) -> SidedAnswers:
    """Return answers about one comparison as arrays; see `is_on_right` for the first side."""
    return SidedAnswers(
        responses=answers["value"].to_numpy().astype(np.int64),
        on_right=is_on_right(answers),
        participants=codes(answers, "participant"),
        segments=codes(answers, "segment"),
    )


@dataclass(frozen=True, kw_only=True)
class NetPreference:
    """The cumulative link mixed model's net preference, in logits.

    Attributes
    ----------
    estimate, standard_error : float
        The preference and its standard error; above 0 in favour of the first side.
    p_value : float
        p of the likelihood ratio test.
    wald_p : float
        p of the Wald test.
    log_likelihood : float
        By Laplace's approximation.
    sd_participant, sd_segment : float
        Standard deviations of the preference between participants and between segments.
    thresholds : tuple of float
        Between neighbouring answers.
    answers_given : tuple of int
        The answers that occur; the thresholds lie between them.
    n : int
        Number of answers.
    remark : str
        A caution about the result; empty if there is none.
    reason : str
        Why there is no result; empty if there is one.
    """

    estimate: float = math.nan
    standard_error: float = math.nan
    p_value: float = math.nan
    wald_p: float = math.nan
    log_likelihood: float = math.nan
    sd_participant: float = math.nan
    sd_segment: float = math.nan
    thresholds: tuple[float, ...] = ()
    answers_given: tuple[int, ...] = ()
    n: int
    remark: str = ""
    reason: str = ""


def net_preference(answers: SidedAnswers) -> NetPreference:
    """Fit ``response ~ s + (0 + s | participant) + (0 + s | segment)``, s = ±1 for the side.

    The thresholds absorb side bias; ties remain the middle answer.

    Parameters
    ----------
    answers : SidedAnswers
        Answers to one question about one comparison.
    """
    answers_given = tuple(np.unique(answers.responses).tolist())
    unknown = NetPreference(n=len(answers.responses), answers_given=answers_given)
    if reason := _why_not(answers):
        return replace(unknown, reason=reason)
    side = np.where(answers.on_right, 1.0, -1.0)
    random = [
        RandomEffect(name="participant", groups=answers.participants, multiplier=side),
        RandomEffect(name="segment", groups=answers.segments, multiplier=side),
    ]
    full = fit(answers.responses, {"preference": side}, random)
    reduced = fit(answers.responses, {}, random, errors=False)
    if not full.converged:
        return replace(unknown, reason=full.remark)
    remark = "" if reduced.converged else "Without the preference the model did not converge. "
    return replace(
        unknown,
        estimate=full.estimates["preference"],
        standard_error=full.standard_errors["preference"],
        p_value=likelihood_ratio(full, reduced)[2] if reduced.converged else math.nan,
        wald_p=full.wald_p("preference"),
        log_likelihood=full.log_likelihood,
        sd_participant=full.deviations["participant"],
        sd_segment=full.deviations["segment"],
        thresholds=full.thresholds,
        remark=f"{remark}{full.remark}".strip(),
    )


def _why_not(answers: SidedAnswers) -> str:
    if not len(answers.responses):
        return "no answers"
    if len(np.unique(answers.participants)) < 2:
        return "one participant"
    if len(np.unique(answers.segments)) < 2:
        return "one segment"
    if not answers.signed.any():
        return "all answers are ties"
    if answers.signed.min() > 0 or answers.signed.max() < 0:
        return SEPARATED
    if np.ptp(answers.responses) == 0:
        return "all answers alike"
    if answers.on_right.all() or not answers.on_right.any():
        return ONE_SIDE
    return ""


@dataclass(frozen=True, kw_only=True)
class RatingModel:
    """The model ``rating ~ condition + (1 | participant) + (1 | segment)``, in logits.

    It assumes that conditions differ equally for all participants and segments. If they do not, its
    standard errors are too small, so it gives none; the differences of paired ratings are tested.

    Attributes
    ----------
    reference : str
        The condition whose effect is zero.
    estimates : mapping of condition to float
        Above zero if a condition is rated better than the reference.
    log_likelihood : float
        By Laplace's approximation.
    sd_participant, sd_segment : float
        Standard deviations of ratings between participants and between segments.
    thresholds : tuple of float
        Between neighbouring scores that occur.
    n : int
        Number of ratings.
    remark, reason : str
        A caution about the result; why there is none.
    """

    reference: str = ""
    estimates: Mapping[str, float]
    log_likelihood: float = math.nan
    sd_participant: float = math.nan
    sd_segment: float = math.nan
    thresholds: tuple[float, ...] = ()
    n: int
    remark: str = ""
    reason: str = ""


def rating_model(answers: pd.DataFrame) -> RatingModel:
    """Fit the ratings of one question, with the first condition as the reference."""
    shown = shown_conditions(answers)
    ratings = answers["value"].to_numpy().astype(np.int64)
    scores = tuple(np.unique(ratings).tolist())
    names = answers["condition"].to_numpy(object)
    unknown = RatingModel(
        reference=shown[0],
        estimates=dict.fromkeys(shown, math.nan),
        n=len(ratings),
    )
    random = [
        RandomEffect(name=name, groups=codes(answers, name)) for name in ("participant", "segment")
    ]
    if reason := _why_no_model(shown, scores, random):
        return replace(unknown, reason=reason)
    covariates = {name: (names == name).astype(np.float64) for name in shown[1:]}
    model = fit(ratings, covariates, random)
    if not model.converged:
        return replace(unknown, reason=model.remark)
    return replace(
        unknown,
        estimates={shown[0]: 0.0, **model.estimates},
        log_likelihood=model.log_likelihood,
        sd_participant=model.deviations["participant"],
        sd_segment=model.deviations["segment"],
        thresholds=model.thresholds,
        remark=model.remark,
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
            f"{len(scores)} different ratings are too many for ordered categories; means and "
            "Cliff's delta remain valid"
        )
    return ""
