"""Results of ratings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

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
    of_parts,
    parts,
    set_name,
    shown_conditions,
)
from analysis.results.heterogeneity import PairHeterogeneity, corrected_tests, heterogeneity
from analysis.results.rating_contrasts import (
    MOST_SCORES,
    RatingContrast,
    RatingModel,
    rated_cells_of,
    rating_contrasts,
    rating_model,
    with_holm,
)
from analysis.stats.agreement import Retest
from analysis.stats.equivalence import Equivalence, equivalence_of, equivalence_of_means
from analysis.stats.ratings import RatingSummary, rating_table


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
    """Analyse ratings.

    Parameters
    ----------
    table : AnswerTable
        Of the rating layout.
    left_out : LeftOut
        Who is left out.
    margin : float, optional
        Difference of two means, in scores, that does not matter.
    family : Family
        Which tests decide.
    """
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
        contrasts=with_holm(differences, family),
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
