"""Results of ratings: means, a test of how much better one is rated, and a model that describes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np
import pandas as pd

from analysis.answers.participants import LeftOut
from analysis.answers.table import AnswerTable
from analysis.results.grouping import (
    EVERYTHING,
    ByQuestion,
    ConditionKey,
    Family,
    PairKey,
    as_by_question,
    by_question,
    codes,
    shown_conditions,
    split_by_question,
)
from analysis.results.headline import Agreement, agreement_of, retest_of
from analysis.results.heterogeneity import PairHeterogeneity, correct_tests, heterogeneity
from analysis.stats.agreement import Retest
from analysis.stats.clustered_mean import Estimate
from analysis.stats.one_sample_tests import Equivalence, equivalence_of, equivalence_of_means
from analysis.stats.ordinal.mixed_model import RandomEffect, fit
from analysis.stats.ratings import (
    RatingSummary,
    cliffs_delta,
    mean_difference,
    rated_cells,
    rating_table,
)
from motion.errors import InputError

MOST_SCORES: Final = 21
"""Ratings with more distinct values are not modelled as ordered categories."""


@dataclass(frozen=True, kw_only=True)
class RatingModel:
    """The model ``rating ~ condition + (1 | participant) + (1 | segment)``, in logits.

    It assumes that conditions differ alike for all participants and segments. Where they do not,
    its errors are too small, so it gives none; the differences of paired ratings are tested.

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
        Between neighbouring scores of those that somebody gave.
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
    reason = _why_no_model(shown, scores, random)
    if reason:
        return replace(unknown, reason=reason)
    covariates = {name: (names == name).astype(np.float64) for name in shown[1:]}
    try:
        model = fit(ratings, covariates, random)
    except InputError as error:
        return replace(unknown, reason=error.what)
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
class RatingContrast(PairKey):
    """How much better a is rated than b.

    Attributes
    ----------
    difference : RatedDifference
        Mean difference of paired ratings; the headline.
    log_odds, odds_ratio : float
        Of a better rating for a than for b in the mixed model, which describes and does not test.
    cliffs_delta : Estimate
        How much the ratings of a dominate those of b.
    remark : str
        Why there are no log-odds, or what limits them.
    """

    difference: RatedDifference
    log_odds: float
    odds_ratio: float
    cliffs_delta: Estimate
    remark: str


@dataclass(frozen=True, kw_only=True)
class RatedCondition(RatingSummary, ConditionKey):
    """How a condition was rated."""


@dataclass(frozen=True, kw_only=True)
class RatedEquivalent(Equivalence, PairKey):
    """Equivalence by participants' means, which takes the segments as the only ones.

    Attributes
    ----------
    two_way : Equivalence
        Of the mean difference of paired ratings, for which segments are a sample too; the
        headline.
    """

    two_way: Equivalence


@dataclass(frozen=True, kw_only=True)
class RatingResults:
    """All of them.

    Attributes
    ----------
    conditions : tuple of RatedCondition
        In the order of sets, questions and conditions.
    clmm, agreement, test_retest : mapping of question to result
        See `ByQuestion`.
    contrasts : tuple of RatingContrast
        In the order of sets, questions and conditions.
    equivalence : tuple of RatedEquivalent
        Of participants' mean ratings; empty where no margin was stated.
    heterogeneity : tuple of PairHeterogeneity
        Differences of paired ratings by emotion, speaker and segment.
    """

    conditions: tuple[RatedCondition, ...]
    clmm: ByQuestion[RatingModel]
    contrasts: tuple[RatingContrast, ...]
    agreement: ByQuestion[Agreement]
    test_retest: ByQuestion[Retest]
    equivalence: tuple[RatedEquivalent, ...]
    heterogeneity: tuple[PairHeterogeneity, ...]


def rating_results(
    table: AnswerTable,
    left_out: LeftOut,
    margin: float | None = None,
    family: Family = EVERYTHING,
) -> RatingResults:
    """Analyse ratings; a margin is a difference of two means, in scores, that does not matter."""
    analysed = left_out.analysed
    conditions: list[RatedCondition] = []
    contrasts: list[RatingContrast] = []
    equivalents: list[RatedEquivalent] = []
    effects: list[PairHeterogeneity] = []
    models: dict[tuple[str | None, str], RatingModel] = {}
    for set_name, question, answers in split_by_question(table, analysed):
        model = models[set_name, question] = rating_model(answers)
        shown = shown_conditions(answers)
        conditions += [
            RatedCondition(set=set_name, question=question, **vars(summary))
            for summary in rating_table(answers, shown, scores_of(table), table.limits(question))
        ]
        cells = rated_cells(
            answers["value"].to_numpy(np.float64),
            np.unique(codes(answers, "condition"), return_inverse=True)[1],
            codes(answers, "participant"),
            codes(answers, "segment"),
            count=len(shown),
        )
        for a, b in combinations(range(len(shown)), 2):
            key = PairKey(set=set_name, a=shown[a], b=shown[b], question=question)
            contrast = _contrast(key, answers, mean_difference(cells, a, b), model)
            contrasts.append(contrast)
            if margin is not None:
                equivalents.append(_equivalent(key, answers, contrast.difference, margin))
            differences = cells.means[:, a] - cells.means[:, b]
            paired = ~np.isnan(differences)
            effects += heterogeneity(
                PairHeterogeneity,
                key,
                answers.iloc[cells.first][paired],
                differences[paired],
                measure="difference",
                null=0.0,
            )
    return RatingResults(
        conditions=tuple(conditions),
        clmm=as_by_question(table, models),
        contrasts=family.decide(contrasts, "difference"),
        agreement=by_question(table, analysed, agreement_of),
        test_retest=by_question(table, left_out.kept, retest_of),
        equivalence=tuple(equivalents),
        heterogeneity=correct_tests(effects),
    )


def _contrast(
    key: PairKey, answers: pd.DataFrame, difference: Estimate, model: RatingModel
) -> RatingContrast:
    pair = answers[answers["condition"].isin(key.names)]
    log_odds = model.estimates[key.a] - model.estimates[key.b]
    return RatingContrast(
        **vars(key),
        difference=RatedDifference(**vars(difference)),
        log_odds=log_odds,
        odds_ratio=math.exp(log_odds),
        cliffs_delta=cliffs_delta(
            pair["value"].to_numpy(np.float64),
            (pair["condition"] == key.a).to_numpy(bool),
            codes(pair, "participant"),
            codes(pair, "segment"),
        ),
        remark=model.reason or model.remark,
    )


def _equivalent(
    key: PairKey, answers: pd.DataFrame, difference: Estimate, margin: float
) -> RatedEquivalent:
    """Test the means of those participants who rated both conditions, and paired ratings."""
    means = answers.groupby(["participant", "condition"], observed=True)["value"].mean().unstack()
    return RatedEquivalent(
        **vars(key),
        **vars(equivalence_of_means((means[key.a] - means[key.b]).dropna().to_numpy(), margin)),
        two_way=equivalence_of(difference, margin),
    )


def scores_of(table: AnswerTable) -> tuple[int, ...]:
    """Return all scales' scores, ascending, or the scores given where there are many.

    A scale that is not stated has five points at least.
    """
    scores = np.unique(table.shown["value"].to_numpy()).astype(int).tolist()
    low = min((low for low, _ in table.scales.values()), default=min(1, scores[0]))
    high = max((high for _, high in table.scales.values()), default=max(5, scores[-1]))
    return tuple(range(low, high + 1)) if high - low < MOST_SCORES else tuple(scores)
