"""Results of rankings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.answers.participants import LeftOut
from analysis.answers.table import AnswerTable
from analysis.results.grouping import (
    EVERYTHING,
    ByQuestion,
    ConditionPlace,
    Family,
    PairPlace,
    compared,
    of_parts,
    parts,
    place_of,
    set_name,
    shown_conditions,
)
from analysis.results.heterogeneity import ConditionHeterogeneity, corrected_tests, heterogeneity
from analysis.results.strengths import (
    RANKING,
    PlackettLuceWorths,
    StrengthDifference,
    fit_worths,
)
from analysis.stats.friedman import (
    Concordance,
    Friedman,
    PairwiseRanks,
    compare_pairs,
    friedman,
    kendall_w,
)
from analysis.stats.placements import (
    Placements,
    RankSummary,
    blocks_of_rankings,
    placements,
    rank_summaries,
)


@dataclass(frozen=True, kw_only=True)
class RankedCondition(RankSummary, ConditionPlace):
    """Where a condition is placed."""


@dataclass(frozen=True, kw_only=True)
class RankContrast(PairwiseRanks, PairPlace):
    """Whether two conditions are placed otherwise, after Friedman's test; secondary.

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
    analysed = left_out.analysed
    fitted = {
        (name, question): fit_worths(answers, set_name(table, name), question)
        for name, question, answers in parts(table, analysed)
    }
    placed = {
        (name, question): placements_of(answers)
        for name, question, answers in parts(table, analysed)
    }
    return RankingResults(
        conditions=tuple(
            RankedCondition(set=set_name(table, name), question=question, **vars(one))
            for (name, question), given in placed.items()
            for one in rank_summaries(given)
        ),
        plackett_luce=of_parts(table, {place: one for place, (one, _) in fitted.items()}),
        contrasts=family.decide([one for _, own in fitted.values() for one in own]),
        kendall_w=of_parts(table, {place: concordance(given) for place, given in placed.items()}),
        friedman=of_parts(
            table, {place: friedman(blocks_of_rankings(given)) for place, given in placed.items()}
        ),
        posthoc=tuple(
            RankContrast(set=set_name(table, name), question=question, **vars(pair))
            for (name, question), given in placed.items()
            for pair in compare_pairs(blocks_of_rankings(given))
        ),
        heterogeneity=corrected_tests(_heterogeneity(table, analysed)),
    )


def _heterogeneity(table: AnswerTable, analysed: pd.DataFrame) -> list[ConditionHeterogeneity]:
    found: list[ConditionHeterogeneity] = []
    for of, question, answers in parts(table, analysed):
        count = len(shown_conditions(answers))
        ranks = answers.groupby(RANKING, observed=True, dropna=False)["value"].rank()
        for numbers, rows in compared(answers):
            found += heterogeneity(
                place_of(table, of, question, numbers),
                answers[rows],
                ranks[rows].to_numpy(np.float64),
                measure="mean_rank",
                null=(count + 1) / 2,
                limits=(1.0, count),
            )
    return found


def placements_of(answers: pd.DataFrame) -> Placements:
    """Return the rankings of one question."""
    return placements(answers.rename(columns={"value": "rank"}), shown_conditions(answers))


def concordance(given: Placements) -> Concordance:
    """Return how far participants agree, of several rankings of a segment by their mean."""
    return kendall_w(given.averaged())
