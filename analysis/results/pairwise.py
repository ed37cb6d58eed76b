"""Results of pairs of videos: of two conditions, or of one motion with two speeches."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import pandas as pd

from analysis.answers.participants import LeftOut
from analysis.answers.table import AnswerTable
from analysis.results.grouping import (
    EVERYTHING,
    ByQuestion,
    Family,
    PairKey,
    as_by_question,
    by_question,
    is_on_right,
    split_by_question,
)
from analysis.results.headline import Agreement, agreement_of, retest_of
from analysis.results.heterogeneity import (
    ConditionHeterogeneity,
    PairHeterogeneity,
    correct_tests,
    preference_heterogeneity,
)
from analysis.results.preference import Comparison, MatchedCondition, left_share, preferences
from analysis.results.strengths import BradleyTerryStrengths, StrengthDifference, fit_strengths
from analysis.stats.agreement import Retest
from analysis.stats.clustered_mean import Estimate
from analysis.stats.one_sample_tests import Equivalence, equivalence

MOST_PAIRED: Final = 3
"""Most conditions for which single comparisons decide; with more, their strengths decide."""


@dataclass(frozen=True, kw_only=True)
class Equivalent(Equivalence, PairKey):
    """Whether a's win share differs from one half, or two mean ratings, by less than the margin."""


@dataclass(frozen=True, kw_only=True)
class SideBias:
    """How often the left side is preferred, and how often a (or the own speech) was there.

    Attributes
    ----------
    left_share : Estimate
        Share of preferences for the left; ties count as one half.
    on_left : float
        Share of the answers for which a, or the video with its own speech, was on the left.
    """

    left_share: Estimate
    on_left: float


@dataclass(frozen=True, kw_only=True)
class PairwiseResults:
    """All of them.

    Attributes
    ----------
    comparisons : tuple of Comparison
        In the order of sets, conditions and questions.
    side_bias, agreement, test_retest, bradley_terry : mapping of question to result
        See `ByQuestion`.
    contrasts : tuple of StrengthDifference
        Each pair of conditions by strengths, in the order of sets and questions.
    decided_by : {'comparisons', 'strengths'}
        The basis of the report's first sentences: strengths if more than three conditions are
        compared, unless all comparisons share one condition.
    equivalence : tuple of Equivalent
        In the order of `comparisons`; empty if no margin was stated.
    heterogeneity : tuple of PairHeterogeneity
        Win shares by emotion, speaker and segment, in the order of `comparisons`.
    """

    comparisons: tuple[Comparison, ...]
    side_bias: ByQuestion[SideBias]
    agreement: ByQuestion[Agreement]
    test_retest: ByQuestion[Retest]
    bradley_terry: ByQuestion[BradleyTerryStrengths]
    contrasts: tuple[StrengthDifference, ...]
    decided_by: Literal["comparisons", "strengths"]
    equivalence: tuple[Equivalent, ...]
    heterogeneity: tuple[PairHeterogeneity, ...]


def pairwise_results(
    table: AnswerTable,
    left_out: LeftOut,
    margin: float | None = None,
    family: Family = EVERYTHING,
) -> PairwiseResults:
    """Analyse pairwise comparisons.

    Parameters
    ----------
    table : AnswerTable
        Answers in the pairwise layout.
    left_out : LeftOut
        The exclusions.
    margin : float, optional
        Difference of a win share from one half that does not matter.
    family : Family
        The tests that decide.
    """
    analysed = left_out.analysed

    def order(result: PairKey) -> tuple[int, int, int, int]:
        return (
            table.sets.index(result.set or ""),
            table.conditions.index(result.a),
            table.conditions.index(result.b),
            table.questions.index(result.question),
        )

    comparisons = family.decide(
        sorted(preferences(Comparison, table, left_out.exclusions), key=order), "decision"
    )
    strengths = {
        (set_name, question): fit_strengths(answers, set_name, question)
        for set_name, question, answers in split_by_question(table, analysed)
    }
    return PairwiseResults(
        comparisons=comparisons,
        side_bias=by_question(table, analysed, _side_bias),
        agreement=by_question(table, analysed, agreement_of),
        test_retest=by_question(table, left_out.kept, retest_of),
        bradley_terry=as_by_question(table, {key: fit for key, (fit, _) in strengths.items()}),
        contrasts=family.decide(
            [each for _, differences in strengths.values() for each in differences]
        ),
        decided_by=_decided_by(comparisons),
        equivalence=()
        if margin is None
        else tuple(_equivalent(comparison, margin) for comparison in comparisons),
        heterogeneity=correct_tests(
            sorted(preference_heterogeneity(PairHeterogeneity, table, analysed), key=order)
        ),
    )


def _decided_by(comparisons: Sequence[Comparison]) -> Literal["comparisons", "strengths"]:
    for name in dict.fromkeys(comparison.set for comparison in comparisons):
        pairs = [set(comparison.names) for comparison in comparisons if comparison.set == name]
        if len(set().union(*pairs)) > MOST_PAIRED and not set.intersection(*pairs):
            return "strengths"
    return "comparisons"


def _equivalent(comparison: Comparison, margin: float) -> Equivalent:
    return Equivalent(
        **{name: getattr(comparison, name) for name in ("set", "a", "b", "question")},
        **vars(equivalence(comparison.win_share, margin, null=0.5)),
    )


def _side_bias(answers: pd.DataFrame) -> SideBias:
    return SideBias(left_share=left_share(answers), on_left=float((~is_on_right(answers)).mean()))


@dataclass(frozen=True, kw_only=True)
class MismatchResults:
    """All of them.

    Attributes
    ----------
    conditions : tuple of MatchedCondition
        In the order of sets, conditions and questions.
    side_bias, agreement, test_retest : mapping of question to result
        See `ByQuestion`.
    heterogeneity : tuple of ConditionHeterogeneity
        Win shares of the own speech by emotion, speaker and segment.
    """

    conditions: tuple[MatchedCondition, ...]
    side_bias: ByQuestion[SideBias]
    agreement: ByQuestion[Agreement]
    test_retest: ByQuestion[Retest]
    heterogeneity: tuple[ConditionHeterogeneity, ...]


def mismatch_results(
    table: AnswerTable, left_out: LeftOut, family: Family = EVERYTHING
) -> MismatchResults:
    """Analyse mismatch trials.

    Parameters
    ----------
    table : AnswerTable
        Answers in the mismatch layout.
    left_out : LeftOut
        The exclusions.
    family : Family
        The tests that decide.
    """
    analysed = left_out.analysed
    conditions = preferences(MatchedCondition, table, left_out.exclusions)
    return MismatchResults(
        conditions=family.decide(conditions, "decision"),
        side_bias=by_question(table, analysed, _side_bias),
        agreement=by_question(table, analysed, agreement_of),
        test_retest=by_question(table, left_out.kept, retest_of),
        heterogeneity=correct_tests(
            preference_heterogeneity(ConditionHeterogeneity, table, analysed)
        ),
    )
