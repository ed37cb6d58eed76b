"""Results of pairwise comparisons."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.columns import ANALYSED_KINDS
from analysis.answers.table import AnswerTable
from analysis.results.agreement import Agreement, agreement_of, retest_of
from analysis.results.family import EVERYTHING, Family
from analysis.results.grouping import (
    ByQuestion,
    PairPlace,
    by_question,
    codes,
    nested,
    parts,
    set_name,
)
from analysis.results.heterogeneity import PairHeterogeneity, corrected_tests, heterogeneity
from analysis.results.net_preference import sided
from analysis.results.participants import LeftOut
from analysis.results.preference import Comparison, left_share, preference, with_holm
from analysis.results.strengths import (
    StrengthContrast,
    Strengths,
    corrected_contrasts,
    strengths_of,
)
from analysis.stats.clustered_mean import Estimate
from analysis.stats.equivalence import Equivalence, equivalence_of
from analysis.stats.retest import Retest

MOST_PAIRED: Final = 3
"""Conditions up to which single comparisons decide; of more, the strengths of all of them."""


@dataclass(frozen=True, kw_only=True)
class Equivalent(Equivalence, PairPlace):
    """Whether a's win share is as near to one half as the margin."""


@dataclass(frozen=True, kw_only=True)
class SideBias:
    """How often the left side is preferred, ties counting one half; and how often a was there."""

    left_share: Estimate
    a_on_left: float


@dataclass(frozen=True, kw_only=True)
class PairwiseResults:
    """All of them.

    Attributes
    ----------
    comparisons : tuple of Comparison
        In the order of sets, conditions and questions.
    side_bias, agreement, test_retest, bradley_terry : mapping of question to result
        See `ByQuestion`.
    contrasts : tuple of StrengthContrast
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
    bradley_terry: ByQuestion[Strengths]
    contrasts: tuple[StrengthContrast, ...]
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
    comparisons = with_holm(_comparisons(table, left_out.exclusions), family)
    fitted = {
        (name, question): strengths_of(answers, set_name(table, name), question)
        for name, question, answers in parts(table, analysed)
    }
    return PairwiseResults(
        comparisons=comparisons,
        side_bias=by_question(table, analysed, _side_bias),
        agreement=by_question(table, analysed, pairwise_agreement),
        test_retest=by_question(table, left_out.kept, pairwise_retest),
        bradley_terry=nested(table, {place: one for place, (one, _) in fitted.items()}),
        contrasts=corrected_contrasts(
            [one for _, contrasts in fitted.values() for one in contrasts], family
        ),
        decided_by=_decided_by(comparisons),
        equivalence=tuple(_equivalent(one, margin) for one in comparisons if margin is not None),
        heterogeneity=corrected_tests(_heterogeneity(table, analysed)),
    )


def _decided_by(comparisons: Sequence[Comparison]) -> Literal["comparisons", "strengths"]:
    for name in dict.fromkeys(one.set for one in comparisons):
        pairs = [{one.a, one.b} for one in comparisons if one.set == name]
        if len(set().union(*pairs)) > MOST_PAIRED and not set.intersection(*pairs):
            return "strengths"
    return "comparisons"


def _comparisons(table: AnswerTable, excluded: Mapping[str, str]) -> list[Comparison]:
    """Return every pair that was shown in a main or repeated trial, with every question."""
    count = len(table.conditions)
    found = []
    for name, question, part in parts(table, table.shown):
        first, second = codes(part, "left"), codes(part, "right")
        pairs = np.minimum(first, second) * count + np.maximum(first, second)
        analysed = part["kind"].isin(ANALYSED_KINDS).to_numpy(bool)
        for pair in np.unique(pairs[analysed]).tolist():
            a, b = divmod(pair, count)
            chosen = pairs == pair
            found.append(
                Comparison(
                    set=set_name(table, name),
                    a=table.conditions[a],
                    b=table.conditions[b],
                    question=question,
                    **vars(preference(part[chosen], (second == a)[chosen], excluded, ("a", "b"))),
                )
            )
    return sorted(found, key=lambda one: _order(table, one))


def _heterogeneity(table: AnswerTable, analysed: pd.DataFrame) -> list[PairHeterogeneity]:
    found: list[PairHeterogeneity] = []
    for name, question, answers in parts(table, analysed):
        pairs = _pair(answers)
        number = pairs["a"] * len(table.conditions) + pairs["b"]
        for pair in np.unique(number).tolist():
            a, b = divmod(pair, len(table.conditions))
            place = PairPlace(
                set=set_name(table, name),
                a=table.conditions[a],
                b=table.conditions[b],
                question=question,
            )
            own = answers[number == pair]
            wins = sided(own, codes(own, "right") == a).wins
            found += heterogeneity(
                place, own, wins, measure="win_share", null=0.5, limits=(0.0, 1.0)
            )
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
        a_on_left=float((codes(answers, "left") < codes(answers, "right")).mean()),
    )


def pairwise_agreement(answers: pd.DataFrame) -> Agreement:
    """Agree about a segment's comparison: how far a is preferred to b in it."""
    shown = [*_pair(answers).values(), codes(answers, "segment")]
    items = np.unique(np.stack(shown), axis=1, return_inverse=True)[1].ravel()
    return agreement_of(
        _towards(answers), codes(answers, "participant"), np.asarray(items, np.intp)
    )


def pairwise_retest(answers: pd.DataFrame) -> Retest:
    """Compare practice trials with their repeats."""
    return retest_of(answers, _towards(answers), _pair(answers))


def _pair(answers: pd.DataFrame) -> dict[str, NDArray[np.intp]]:
    left, right = codes(answers, "left"), codes(answers, "right")
    return {"a": np.minimum(left, right), "b": np.maximum(left, right)}


def _towards(answers: pd.DataFrame) -> NDArray[np.int64]:
    return sided(answers, codes(answers, "right") < codes(answers, "left")).towards
