"""Results of mismatch trials: one motion with its own speech and with another's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.table import AnswerTable
from analysis.results.agreement import Agreement, agreement_of, retest_of
from analysis.results.family import EVERYTHING, Family
from analysis.results.grouping import (
    ByQuestion,
    ConditionPlace,
    by_question,
    codes,
    parts,
    set_name,
)
from analysis.results.heterogeneity import ConditionHeterogeneity, corrected_tests, heterogeneity
from analysis.results.net_preference import sided
from analysis.results.participants import LeftOut
from analysis.results.preference import MatchedCondition, left_share, preference, with_holm
from analysis.stats.clustered_mean import Estimate
from analysis.stats.retest import Retest


@dataclass(frozen=True, kw_only=True)
class OwnSideBias:
    """How often the left side is preferred, ties counting one half; how often own was there."""

    left_share: Estimate
    own_on_left: float


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
    side_bias: ByQuestion[OwnSideBias]
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
            set=set_name(table, name),
            condition=table.conditions[place],
            question=question,
            **vars(
                preference(answers, own_on_right(answers), left_out.exclusions, ("own", "other"))
            ),
        )
        for name, question, part in parts(table, table.shown)
        for place in range(len(table.conditions))
        if not (answers := part[codes(part, "condition") == place]).empty
    ]
    return MismatchResults(
        conditions=with_holm(found, family),
        side_bias=by_question(table, left_out.analysed, _side_bias),
        agreement=by_question(table, left_out.analysed, mismatch_agreement),
        test_retest=by_question(table, left_out.kept, mismatch_retest),
        heterogeneity=corrected_tests(_heterogeneity(table, left_out.analysed)),
    )


def _heterogeneity(table: AnswerTable, analysed: pd.DataFrame) -> list[ConditionHeterogeneity]:
    return [
        one
        for name, question, answers in parts(table, analysed)
        for number in np.unique(codes(answers, "condition")).tolist()
        for own in (answers[codes(answers, "condition") == number],)
        for one in heterogeneity(
            ConditionPlace(
                set=set_name(table, name), condition=table.conditions[number], question=question
            ),
            own,
            sided(own, own_on_right(own)).wins,
            measure="win_share",
            null=0.5,
            limits=(0.0, 1.0),
        )
    ]


def own_on_right(answers: pd.DataFrame) -> NDArray[np.bool_]:
    """Tell where the video with its own speech was on the right."""
    return np.asarray(answers["right_speech"] == "own", bool)


def _side_bias(answers: pd.DataFrame) -> OwnSideBias:
    return OwnSideBias(
        left_share=left_share(answers), own_on_left=float((~own_on_right(answers)).mean())
    )


def mismatch_agreement(answers: pd.DataFrame) -> Agreement:
    """Agree about a segment's condition: how far its own speech is preferred."""
    count = len(answers["condition"].cat.categories)
    items = codes(answers, "segment") * count + codes(answers, "condition")
    return agreement_of(_towards(answers), codes(answers, "participant"), items)


def mismatch_retest(answers: pd.DataFrame) -> Retest:
    """Compare practice trials with their repeats."""
    return retest_of(answers, _towards(answers), {"condition": codes(answers, "condition")})


def _towards(answers: pd.DataFrame) -> NDArray[np.int64]:
    return sided(answers, own_on_right(answers)).towards
