"""Results of rankings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

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
    shown_conditions,
    split_by_key,
    split_by_question,
)
from analysis.results.heterogeneity import ConditionHeterogeneity, correct_tests, heterogeneity
from analysis.results.strengths import (
    RANKING,
    PlackettLuceWorths,
    StrengthDifference,
    fit_worths,
)
from analysis.stats.agreement import Concordance, kendall_w
from analysis.stats.rankings import (
    Friedman,
    PairwiseRanks,
    Placements,
    RankSummary,
    blocks_of_rankings,
    compare_pairs,
    friedman,
    placements,
    rank_summaries,
)


@dataclass(frozen=True, kw_only=True)
class RankedCondition(RankSummary, ConditionKey):
    """Where a condition is placed."""


@dataclass(frozen=True, kw_only=True)
class RankContrast(PairwiseRanks, PairKey):
    """Whether two conditions are placed differently, after Friedman's test; secondary.

    It rests on participants' mean ranks and takes the segments as the only ones of interest.
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
        Every two conditions by their worths, in the order of sets and questions; the headline.
    posthoc : tuple of RankContrast
        Every two conditions, in the order of sets and questions.
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
    """Analyse rankings.

    Parameters
    ----------
    table : AnswerTable
        Of the ranking layout.
    left_out : LeftOut
        Who is left out.
    family : Family
        Which tests decide.
    """
    fits: dict[tuple[str | None, str], PlackettLuceWorths] = {}
    agreements: dict[tuple[str | None, str], Concordance] = {}
    tests: dict[tuple[str | None, str], Friedman] = {}
    conditions: list[RankedCondition] = []
    contrasts: list[StrengthDifference] = []
    posthoc: list[RankContrast] = []
    effects: list[ConditionHeterogeneity] = []
    for set_name, question, answers in split_by_question(table, left_out.analysed):
        key = set_name, question
        rankings = placements_of(answers)
        blocks = blocks_of_rankings(rankings)
        fits[key], differences = fit_worths(answers, set_name, question)
        contrasts += differences
        agreements[key] = concordance(rankings)
        tests[key] = friedman(blocks)
        conditions += [
            RankedCondition(set=set_name, question=question, **vars(summary))
            for summary in rank_summaries(rankings)
        ]
        posthoc += [
            RankContrast(set=set_name, question=question, **vars(pair))
            for pair in compare_pairs(blocks)
        ]
        effects += _heterogeneity(table, answers)
    return RankingResults(
        conditions=tuple(conditions),
        plackett_luce=as_by_question(table, fits),
        kendall_w=as_by_question(table, agreements),
        friedman=as_by_question(table, tests),
        contrasts=family.decide(contrasts),
        posthoc=tuple(posthoc),
        heterogeneity=correct_tests(effects),
    )


def _heterogeneity(table: AnswerTable, answers: pd.DataFrame) -> Iterator[ConditionHeterogeneity]:
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


def placements_of(answers: pd.DataFrame) -> Placements:
    """Return the rankings of one question."""
    return placements(answers.rename(columns={"value": "rank"}), shown_conditions(answers))


def concordance(rankings: Placements) -> Concordance:
    """Return how far participants agree; several rankings of a segment count as their mean."""
    return kendall_w(rankings.averaged())
