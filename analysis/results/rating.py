"""Results of ratings: means, a test of how much better one is rated, and a model that describes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np
import pandas as pd

from analysis.answers.participants import LeftOut
from analysis.answers.table import AnswerTable
from analysis.results.agreement import Agreement, agreement_of, retest_of
from analysis.results.grouping import (
    EVERYTHING,
    ByQuestion,
    ConditionPlace,
    Family,
    PairPlace,
    by_question,
    codes,
    of_parts,
    parts,
    set_name,
    shown_conditions,
)
from analysis.results.heterogeneity import PairHeterogeneity, corrected_tests, heterogeneity
from analysis.stats.agreement import Retest
from analysis.stats.clustered_mean import Estimate
from analysis.stats.equivalence import Equivalence, equivalence_of, equivalence_of_means
from analysis.stats.ordinal.mixed_model import RandomEffect, fit
from analysis.stats.ratings import (
    RatedCells,
    RatingSummary,
    cliffs_delta,
    mean_differences,
    rated_cells,
    rating_table,
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


@dataclass(frozen=True, kw_only=True)
class RatedCondition(RatingSummary, ConditionPlace):
    """How a condition was rated."""


@dataclass(frozen=True, kw_only=True)
class RatedEquivalent(Equivalence, PairPlace):
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
    differences: list[RatingContrast] = []
    equivalents: list[RatedEquivalent] = []
    apart: list[PairHeterogeneity] = []
    models: dict[tuple[str, str], RatingModel] = {}
    for name, question, answers in parts(table, analysed):
        shown = shown_conditions(answers)
        of = set_name(table, name)
        models[name, question] = rating_model(answers, shown)
        conditions += [
            RatedCondition(set=of, question=question, **vars(one))
            for one in rating_table(answers, shown, scores_of(table), limits_of(table, question))
        ]
        differences += rating_contrasts(of, question, answers, shown, models[name, question])
        apart += _heterogeneity(of, question, answers, shown)
        if margin is not None:
            own = [one for one in differences if (one.set, one.question) == (of, question)]
            equivalents += _equivalents(answers, own, margin)
    return RatingResults(
        conditions=tuple(conditions),
        clmm=of_parts(table, models),
        contrasts=family.decide(differences, "difference"),
        agreement=by_question(table, analysed, agreement_of),
        test_retest=by_question(table, left_out.kept, retest_of),
        equivalence=tuple(equivalents),
        heterogeneity=corrected_tests(apart),
    )


def scores_of(table: AnswerTable) -> tuple[int, ...]:
    """Return all scales' scores, ascending, or the scores given where there are many.

    A scale that is not stated has five points at least.
    """
    given = np.unique(table.shown["value"].to_numpy()).astype(int).tolist()
    low = min((low for low, _ in table.scales.values()), default=min(1, given[0]))
    high = max((high for _, high in table.scales.values()), default=max(5, given[-1]))
    return tuple(range(low, high + 1)) if high - low < MOST_SCORES else tuple(given)


def limits_of(table: AnswerTable, question: str) -> tuple[float, float]:
    """Return where ratings can lie: anywhere, unless the scale is stated."""
    return table.scales.get(question, (-math.inf, math.inf))


def _equivalents(
    answers: pd.DataFrame, contrasts: Sequence[RatingContrast], margin: float
) -> list[RatedEquivalent]:
    """Test the means of those participants who rated both conditions, and paired ratings."""
    means = answers.pivot_table(
        index="participant", columns="condition", values="value", aggfunc="mean", observed=True
    )
    found = []
    for one in contrasts:
        differences = (means[one.a] - means[one.b]).dropna().to_numpy(np.float64)
        found.append(
            RatedEquivalent(
                set=one.set,
                a=one.a,
                b=one.b,
                question=one.question,
                **vars(equivalence_of_means(differences, margin)),
                two_way=equivalence_of(one.difference, margin),
            )
        )
    return found


def _heterogeneity(
    of: str | None, question: str, answers: pd.DataFrame, shown: tuple[str, ...]
) -> list[PairHeterogeneity]:
    """Take differences of paired ratings apart; ratings without a partner are left out."""
    cells = rated_cells_of(answers, len(shown))
    rows = answers.iloc[cells.first]
    found: list[PairHeterogeneity] = []
    for a, b in combinations(range(len(shown)), 2):
        differences = cells.means[:, a] - cells.means[:, b]
        both = ~np.isnan(differences)
        place = PairPlace(set=of, a=shown[a], b=shown[b], question=question)
        found += heterogeneity(place, rows[both], differences[both], measure="difference", null=0.0)
    return found
