"""The headline numbers: of what is reported, with and without exclusions, and of answers so far."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

import numpy as np
import pandas as pd

from analysis.answers.participants import LeftOut
from analysis.answers.table import AnswerTable
from analysis.results.grouping import (
    ConditionKey,
    ResultKey,
    codes,
    split_by_key,
    split_by_question,
)
from analysis.results.net_preference import sided
from analysis.results.preference import win_share
from analysis.results.ranking import placements_of
from analysis.results.rating import limits_of
from analysis.stats.clustered_mean import Estimate, clustered_mean
from analysis.stats.placements import rank_summaries

Measure = Literal["win_share", "own_speech", "mean_rating", "mean_rank"]


@dataclass(frozen=True, kw_only=True)
class HeadlineNumber(Estimate):
    """A win share of a, a share of preferences for a's own speech, or a's mean rating or rank.

    Attributes
    ----------
    set : str or None
        None where the table has no sets.
    question : str
        What was asked.
    a, b : str
        The condition, and the one that it is compared with; empty where there is none.
    measure : {'win_share', 'own_speech', 'mean_rating', 'mean_rank'}
        What the number is; a share counts ties one half.
    """

    set: str | None
    question: str
    a: str
    b: str = ""
    measure: Measure


@dataclass(frozen=True, kw_only=True)
class Sensitivity:
    """How much one headline number depends on who is left out.

    Attributes
    ----------
    set, question, measure
        As in `HeadlineNumber`.
    conditions : tuple of str
        The condition, or a and b.
    analysed : Estimate
        As reported.
    as_planned : Estimate
        With the rules alone that were settled beforehand.
    everyone : Estimate
        When nobody is excluded.
    """

    set: str | None
    question: str
    conditions: tuple[str, ...]
    measure: Measure
    analysed: Estimate
    as_planned: Estimate
    everyone: Estimate

    @property
    def is_as_planned(self) -> bool:
        """Whether the rules that were settled beforehand give the same as all rules."""
        # As text, in which a number that does not exist equals another one.
        return str(self.analysed) == str(self.as_planned)


def headline_numbers(table: AnswerTable, answers: pd.DataFrame) -> tuple[HeadlineNumber, ...]:
    """Return the headline numbers of some of a table's answers.

    Pages show them before the end of a study: estimates and intervals, without p.

    Returns
    -------
    tuple of HeadlineNumber
        In the order of sets, questions and conditions.
    """
    return tuple(
        HeadlineNumber(
            **vars(estimate),
            set=key.set,
            question=key.question,
            a=key.names[0],
            b="".join(key.names[1:]),
            measure=MEASURES[table.protocol],
        )
        for key, estimate in _estimates(table, answers)
    )


def sensitivity(table: AnswerTable, left_out: LeftOut) -> tuple[Sensitivity, ...]:
    """Return every headline number with and without exclusions.

    Parameters
    ----------
    table : AnswerTable
        All answers.
    left_out : LeftOut
        Who is left out.

    Returns
    -------
    tuple of Sensitivity
        In the order of sets, questions and conditions; empty where nobody is left out, neither
        by all rules nor by those that were planned.
    """
    if not left_out.exclusions and left_out.is_as_planned:
        return ()

    everyone, analysed = (
        dict(_estimates(table, answers)) for answers in (left_out.everyone, left_out.analysed)
    )
    planned = analysed if left_out.is_as_planned else dict(_estimates(table, left_out.as_planned))
    return tuple(
        Sensitivity(
            set=key.set,
            question=key.question,
            conditions=key.names,
            measure=MEASURES[table.protocol],
            analysed=analysed.get(key, NOBODY),
            as_planned=planned.get(key, NOBODY),
            everyone=estimate,
        )
        for key, estimate in everyone.items()
    )


NOBODY: Final = Estimate(reason="nobody who answered this is analysed")

MEASURES: Final[Mapping[str, Measure]] = MappingProxyType(
    {
        "pairwise": "win_share",
        "mismatch": "own_speech",
        "rating": "mean_rating",
        "ranking": "mean_rank",
    }
)
"""What the headline numbers of each protocol are."""


def _estimates(table: AnswerTable, answers: pd.DataFrame) -> Iterator[tuple[ResultKey, Estimate]]:
    if table.protocol == "ranking":
        for set_name, question, part in split_by_question(table, answers):
            for summary in rank_summaries(placements_of(part)):
                yield (
                    ConditionKey(set=set_name, condition=summary.condition, question=question),
                    summary.mean_rank,
                )
        return
    for key, part in split_by_key(table, answers):
        if table.protocol == "rating":
            yield (
                key,
                clustered_mean(
                    part["value"].to_numpy(np.float64),
                    codes(part, "participant"),
                    codes(part, "segment"),
                    null=math.nan,
                    limits=limits_of(table, key.question),
                ),
            )
        else:
            yield key, win_share(sided(part))
