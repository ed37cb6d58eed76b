"""The headline numbers: of what is reported, with and without exclusions, and of answers so far."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

import numpy as np
import pandas as pd

from analysis.answers.participants import LeftOut
from analysis.answers.table import AnswerTable
from analysis.results.grouping import codes, compared, parts, set_name
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
    """How far one headline number depends on who is left out.

    Attributes
    ----------
    set, question, measure
        As in `HeadlineNumber`.
    conditions : tuple of str
        The condition, or a and b.
    analysed : Estimate
        As reported.
    as_planned : Estimate
        By the rules alone that were settled beforehand.
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
    """Return the headline numbers of a part of a table's answers.

    Who looks before the end of a study is to see sizes and how wide open they are, and no p.

    Returns
    -------
    tuple of HeadlineNumber
        In the order of sets, questions and conditions.
    """
    return tuple(
        HeadlineNumber(
            **vars(found),
            set=of,
            question=question,
            a=conditions[0],
            b="".join(conditions[1:]),
            measure=_HEADLINES[table.protocol][0],
        )
        for (of, question, conditions), found in _numbers(table, answers)
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
        dict(_numbers(table, answers)) for answers in (left_out.everyone, left_out.analysed)
    )
    planned = analysed if left_out.is_as_planned else dict(_numbers(table, left_out.as_planned))
    return tuple(
        Sensitivity(
            set=key[0],
            question=key[1],
            conditions=key[2],
            measure=_HEADLINES[table.protocol][0],
            analysed=analysed.get(key, NOBODY),
            as_planned=planned.get(key, NOBODY),
            everyone=number,
        )
        for key, number in everyone.items()
    )


NOBODY: Final = Estimate(reason="nobody who answered this is analysed")

Key = tuple[str | None, str, tuple[str, ...]]
"""Set, question and conditions."""

Estimates = Iterator[tuple[tuple[str, ...], Estimate]]
"""Conditions, and their number."""


def _numbers(table: AnswerTable, answers: pd.DataFrame) -> Iterator[tuple[Key, Estimate]]:
    for name, question, part in parts(table, answers):
        for conditions, found in _HEADLINES[table.protocol][1](table, part):
            yield (set_name(table, name), question, conditions), found


def _shares(table: AnswerTable, answers: pd.DataFrame) -> Estimates:
    """Give the win shares of a in every pair, or of each condition's own speech."""
    for numbers, rows in compared(answers):
        yield _names(table, numbers), win_share(sided(answers[rows]))


def _ratings(table: AnswerTable, answers: pd.DataFrame) -> Estimates:
    limits = limits_of(table, str(answers["question"].iloc[0]))
    for numbers, rows in compared(answers):
        own = answers[rows]
        values, who = own["value"].to_numpy(np.float64), codes(own, "participant")
        mean = clustered_mean(values, who, codes(own, "segment"), null=math.nan, limits=limits)
        yield _names(table, numbers), mean


def _ranks(_table: AnswerTable, answers: pd.DataFrame) -> Estimates:
    for one in rank_summaries(placements_of(answers)):
        yield (one.condition,), one.mean_rank


def _names(table: AnswerTable, numbers: tuple[int, ...]) -> tuple[str, ...]:
    return tuple(table.conditions[number] for number in numbers)


_HEADLINES: Final = MappingProxyType[
    str, tuple[Measure, Callable[[AnswerTable, pd.DataFrame], Estimates]]
](
    {
        "pairwise": ("win_share", _shares),
        "mismatch": ("own_speech", _shares),
        "rating": ("mean_rating", _ratings),
        "ranking": ("mean_rank", _ranks),
    }
)
