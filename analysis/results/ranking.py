"""Results of rankings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.answers.table import AnswerTable
from analysis.results.family import EVERYTHING, Family
from analysis.results.grouping import (
    ByQuestion,
    ConditionPlace,
    PairPlace,
    codes,
    nested,
    parts,
    set_name,
    shown_conditions,
)
from analysis.results.heterogeneity import ConditionHeterogeneity, corrected_tests, heterogeneity
from analysis.results.participants import LeftOut
from analysis.results.strengths import (
    RANKING,
    StrengthContrast,
    Worths,
    corrected_contrasts,
    worths_of,
)
from analysis.stats.rankings.friedman import (
    Friedman,
    PairwiseRanks,
    blocks_of_rankings,
    compare_pairs,
    friedman,
)
from analysis.stats.rankings.kendall_w import Concordance, kendall_w
from analysis.stats.rankings.placements import Placements, RankSummary, placements, rank_summaries


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
    contrasts : tuple of StrengthContrast
        Every two conditions by their worths, in the order of sets and questions; the headline.
    posthoc : tuple of RankContrast
        Every two conditions, in the order of sets and questions.
    heterogeneity : tuple of ConditionHeterogeneity
        Mean ranks by emotion, speaker and segment.
    """

    conditions: tuple[RankedCondition, ...]
    plackett_luce: ByQuestion[Worths]
    kendall_w: ByQuestion[Concordance]
    friedman: ByQuestion[Friedman]
    contrasts: tuple[StrengthContrast, ...]
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
        (name, question): worths_of(answers, set_name(table, name), question)
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
        plackett_luce=nested(table, {place: one for place, (one, _) in fitted.items()}),
        contrasts=corrected_contrasts(
            [one for _, contrasts in fitted.values() for one in contrasts], family
        ),
        kendall_w=nested(table, {place: concordance(given) for place, given in placed.items()}),
        friedman=nested(
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
    for name, question, answers in parts(table, analysed):
        shown = np.unique(codes(answers, "condition")).tolist()
        ranks = answers.groupby(RANKING, observed=True, dropna=False)["value"].rank()
        for place in shown:
            own = codes(answers, "condition") == place
            found += heterogeneity(
                ConditionPlace(
                    set=set_name(table, name), condition=table.conditions[place], question=question
                ),
                answers[own],
                ranks[own].to_numpy(np.float64),
                measure="mean_rank",
                null=(len(shown) + 1) / 2,
                limits=(1.0, len(shown)),
            )
    return found


def placements_of(answers: pd.DataFrame) -> Placements:
    """Return the rankings of one question."""
    return placements(answers.rename(columns={"value": "rank"}), shown_conditions(answers))


def concordance(given: Placements) -> Concordance:
    """Return how far participants agree, of several rankings of a segment by their mean."""
    return kendall_w(given.averaged())
