"""Results of pairs of videos: of two conditions, or of one motion with two speeches."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import pandas as pd

from analysis.answers.participants import LeftOut
from analysis.answers.table import ANALYSED_KINDS, AnswerTable
from analysis.results.agreement import Agreement, agreement_of, retest_of
from analysis.results.grouping import (
    EVERYTHING,
    ByQuestion,
    Family,
    PairPlace,
    by_question,
    compared,
    of_parts,
    on_right,
    parts,
    place_of,
    set_name,
)
from analysis.results.heterogeneity import (
    ConditionHeterogeneity,
    PairHeterogeneity,
    corrected_tests,
    preference_heterogeneity,
)
from analysis.results.preference import (
    Comparison,
    MatchedCondition,
    left_share,
    preference,
)
from analysis.results.strengths import (
    BradleyTerryStrengths,
    StrengthDifference,
    fit_strengths,
)
from analysis.stats.agreement import Retest
from analysis.stats.clustered_mean import Estimate
from analysis.stats.equivalence import Equivalence, equivalence_of

MOST_PAIRED: Final = 3
"""Conditions up to which single comparisons decide; of more, the strengths of all of them."""


@dataclass(frozen=True, kw_only=True)
class Equivalent(Equivalence, PairPlace):
    """Whether a's win share is as near to one half as the margin."""


@dataclass(frozen=True, kw_only=True)
class SideBias:
    """How often the left side is preferred, and how often a, or the own speech, was there.

    Attributes
    ----------
    left_share : Estimate
        Ties count one half.
    on_left : float
        Share of the answers for which a, or the video with its own speech, stood on the left.
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
        Every two conditions by their strengths, in the order of sets and questions.
    decided_by : {'comparisons', 'strengths'}
        What the report's first sentences rest on: strengths where more than three conditions are
        compared, unless all of them are compared with one alone.
    equivalence : tuple of Equivalent
        In the order of `comparisons`; empty where no margin was stated.
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
        Of the pairwise layout.
    left_out : LeftOut
        Who is left out.
    margin : float, optional
        Difference of a win share from one half that does not matter.
    family : Family
        Which tests decide.
    """
    analysed = left_out.analysed
    comparisons = family.decide(_comparisons(table, left_out.exclusions), "decision")
    fitted = {
        (name, question): fit_strengths(answers, set_name(table, name), question)
        for name, question, answers in parts(table, analysed)
    }
    return PairwiseResults(
        comparisons=comparisons,
        side_bias=by_question(table, analysed, _side_bias),
        agreement=by_question(table, analysed, agreement_of),
        test_retest=by_question(table, left_out.kept, retest_of),
        bradley_terry=of_parts(table, {place: one for place, (one, _) in fitted.items()}),
        contrasts=family.decide([one for _, own in fitted.values() for one in own]),
        decided_by=_decided_by(comparisons),
        equivalence=tuple(_equivalent(one, margin) for one in comparisons if margin is not None),
        heterogeneity=corrected_tests(
            sorted(preference_heterogeneity(table, analysed), key=lambda one: _order(table, one))
        ),
    )


def _decided_by(comparisons: Sequence[Comparison]) -> Literal["comparisons", "strengths"]:
    for name in dict.fromkeys(one.set for one in comparisons):
        pairs = [{one.a, one.b} for one in comparisons if one.set == name]
        if len(set().union(*pairs)) > MOST_PAIRED and not set.intersection(*pairs):
            return "strengths"
    return "comparisons"


def _comparisons(table: AnswerTable, excluded: Mapping[str, str]) -> list[Comparison]:
    """Return every pair that was shown in a main or repeated trial, with every question."""
    found = []
    for of, question, part in parts(table, table.shown):
        analysed = part["kind"].isin(ANALYSED_KINDS).to_numpy(bool)
        for numbers, rows in compared(part):
            if analysed[rows].any():
                place = place_of(table, of, question, numbers)
                answers = preference(part[rows], excluded, ("a", "b"))
                found.append(Comparison(**vars(place), **vars(answers)))
    return sorted(found, key=lambda one: _order(table, one))


def _order(table: AnswerTable, one: PairPlace) -> tuple[int, int, int, int]:
    return (
        table.sets.index(one.set or ""),
        table.conditions.index(one.a),
        table.conditions.index(one.b),
        table.questions.index(one.question),
    )


def _equivalent(one: Comparison, margin: float) -> Equivalent:
    found = equivalence_of(one.win_share, margin, null=0.5)
    return Equivalent(set=one.set, a=one.a, b=one.b, question=one.question, **vars(found))


def _side_bias(answers: pd.DataFrame) -> SideBias:
    return SideBias(
        left_share=left_share(answers),
        on_left=float((~on_right(answers)).mean()),
    )


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
        Of the mismatch layout.
    left_out : LeftOut
        Who is left out.
    family : Family
        Which tests decide.
    """
    found = [
        MatchedCondition(
            **vars(place_of(table, of, question, numbers)),
            **vars(preference(part[rows], left_out.exclusions, ("own", "other"))),
        )
        for of, question, part in parts(table, table.shown)
        for numbers, rows in compared(part)
    ]
    return MismatchResults(
        conditions=family.decide(found, "decision"),
        side_bias=by_question(table, left_out.analysed, _side_bias),
        agreement=by_question(table, left_out.analysed, agreement_of),
        test_retest=by_question(table, left_out.kept, retest_of),
        heterogeneity=corrected_tests(preference_heterogeneity(table, left_out.analysed)),
    )
