"""Results of conditions that were rated or ranked one by one."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

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
    split_by_key,
    split_by_question,
)
from analysis.results.headline import Agreement, agreement_of, concordance, placements_of, retest_of
from analysis.results.heterogeneity import (
    ConditionHeterogeneity,
    PairHeterogeneity,
    correct_tests,
    heterogeneity,
)
from analysis.results.mixed_models import MOST_SCORES, RatingModel, rating_model
from analysis.results.pairwise import Equivalent
from analysis.results.strengths import RANKING, PlackettLuceWorths, StrengthDifference, fit_worths
from analysis.stats.agreement import Concordance, Retest
from analysis.stats.clustered_mean import Estimate
from analysis.stats.one_sample_tests import equivalence
from analysis.stats.rankings import (
    Friedman,
    PairwiseRanks,
    RankSummary,
    blocks_of_rankings,
    compare_pairs,
    friedman,
    rank_summaries,
)
from analysis.stats.ratings import (
    RatingSummary,
    cliffs_delta,
    mean_difference,
    rated_cells,
    rating_table,
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
class RatingContrast(PairKey):
    """How much better a is rated than b.

    Attributes
    ----------
    difference : RatedDifference
        Mean difference of paired ratings; the headline.
    log_odds, odds_ratio : float
        Of a better rating for a than for b, in the mixed model, which is descriptive only.
    cliffs_delta : Estimate
        Dominance of the ratings of a over those of b.
    remark : str
        Why there are no log-odds, or a caution about them.
    """

    difference: RatedDifference
    log_odds: float
    odds_ratio: float
    cliffs_delta: Estimate
    remark: str


@dataclass(frozen=True, kw_only=True)
class RatedCondition(RatingSummary, ConditionKey):
    """The ratings of a condition."""


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
    equivalence : tuple of Equivalent
        By differences of paired ratings; empty if no margin was stated.
    heterogeneity : tuple of PairHeterogeneity
        Differences of paired ratings by emotion, speaker and segment.
    """

    conditions: tuple[RatedCondition, ...]
    clmm: ByQuestion[RatingModel]
    contrasts: tuple[RatingContrast, ...]
    agreement: ByQuestion[Agreement]
    test_retest: ByQuestion[Retest]
    equivalence: tuple[Equivalent, ...]
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
    equivalents: list[Equivalent] = []
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
                equivalent = equivalence(contrast.difference, margin)
                equivalents.append(Equivalent(**vars(key), **vars(equivalent)))
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


def scores_of(table: AnswerTable) -> tuple[int, ...]:
    """Return all scales' scores in ascending order; if there are too many, only those given.

    A scale that is not stated has at least five points.
    """
    scores = np.unique(table.shown["value"].to_numpy()).astype(int).tolist()
    low = min((low for low, _ in table.scales.values()), default=min(1, scores[0]))
    high = max((high for _, high in table.scales.values()), default=max(5, scores[-1]))
    return tuple(range(low, high + 1)) if high - low < MOST_SCORES else tuple(scores)


@dataclass(frozen=True, kw_only=True)
class RankedCondition(RankSummary, ConditionKey):
    """The ranks of a condition."""


@dataclass(frozen=True, kw_only=True)
class RankContrast(PairwiseRanks, PairKey):
    """Whether two conditions are ranked differently, after Friedman's test; secondary.

    It uses participants' mean ranks and treats the segments as fixed.
    """


@dataclass(frozen=True, kw_only=True)
class RankingResults:
    """All of them.

    Attributes
    ----------
    conditions : tuple of RankedCondition
        In the order of sets, questions and conditions.
    plackett_luce, kendall_w, friedman : mapping of question to result
        See `ByQuestion`.
    contrasts : tuple of StrengthDifference
        Each pair of conditions by worths, in the order of sets and questions; the headline.
    posthoc : tuple of RankContrast
        Each pair of conditions, in the order of sets and questions.
    heterogeneity : tuple of ConditionHeterogeneity
        Mean ranks by emotion, speaker and segment.
    """

    conditions: tuple[RankedCondition, ...]
    plackett_luce: ByQuestion[PlackettLuceWorths]
    kendall_w: ByQuestion[Concordance]
    friedman: ByQuestion[Friedman]
    contrasts: tuple[StrengthDifference, ...]
    posthoc: tuple[RankContrast, ...]
    heterogeneity: tuple[ConditionHeterogeneity, ...]


def ranking_results(
    table: AnswerTable, left_out: LeftOut, family: Family = EVERYTHING
) -> RankingResults:
    """Analyse rankings; `family` determines which tests decide."""
    parts = {(name, q): part for name, q, part in split_by_question(table, left_out.analysed)}
    rankings = {key: placements_of(answers) for key, answers in parts.items()}
    blocks = {key: blocks_of_rankings(ranked) for key, ranked in rankings.items()}
    worths = {key: fit_worths(answers, *key) for key, answers in parts.items()}
    return RankingResults(
        conditions=tuple(
            RankedCondition(set=set_name, question=question, **vars(summary))
            for (set_name, question), ranked in rankings.items()
            for summary in rank_summaries(ranked)
        ),
        plackett_luce=as_by_question(table, {key: fit for key, (fit, _) in worths.items()}),
        kendall_w=as_by_question(table, {key: concordance(r) for key, r in rankings.items()}),
        friedman=as_by_question(table, {key: friedman(block) for key, block in blocks.items()}),
        contrasts=family.decide([pair for _, pairs in worths.values() for pair in pairs]),
        posthoc=tuple(
            RankContrast(set=set_name, question=question, **vars(pair))
            for (set_name, question), block in blocks.items()
            for pair in compare_pairs(block)
        ),
        heterogeneity=correct_tests(
            [effect for part in parts.values() for effect in _rank_heterogeneity(table, part)]
        ),
    )


def _rank_heterogeneity(
    table: AnswerTable, answers: pd.DataFrame
) -> Iterator[ConditionHeterogeneity]:
    """Yield the mean ranks of one question by emotion, speaker and segment."""
    count = len(shown_conditions(answers))
    by_ranking = answers.groupby(RANKING, observed=True, dropna=False)["value"]
    ranked = answers.assign(rank=by_ranking.rank(), middle=(by_ranking.transform("size") + 1) / 2)
    for key, part in split_by_key(table, ranked):
        yield from heterogeneity(
            ConditionHeterogeneity,
            key,
            part,
            part["rank"].to_numpy(np.float64),
            measure="mean_rank",
            null=float(part["middle"].mean()),
            limits=(1.0, count),
        )
