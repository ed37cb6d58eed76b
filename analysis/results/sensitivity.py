"""The headline numbers with and without exclusions, and as they were planned."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.table import AnswerTable
from analysis.results.grouping import codes, parts, set_name
from analysis.results.left_out import LeftOut
from analysis.results.rating import limits_of
from analysis.results.sided import sided
from analysis.stats.clustered_mean import Estimate, clustered_mean
from analysis.stats.rankings.placements import placements, rank_summaries

Means = Iterator[tuple[tuple[str, ...], Estimate]]
"""Conditions, and their number."""

Key = tuple[str, str, tuple[str, ...]]
"""Set, question and conditions."""


@dataclass(frozen=True, kw_only=True)
class Number:
    """A headline number of some participants.

    Attributes
    ----------
    n, participants : int
        Answers (of rankings: orders) and participants behind it.
    estimate, low, high : float
        With its 95 % interval, clustered by participant and segment; NaN where there is none.
    reason : str
        Why there is no number, or no interval.
    """

    n: int
    participants: int
    estimate: float
    low: float
    high: float
    reason: str


@dataclass(frozen=True, kw_only=True)
class Sensitivity:
    """How far one headline number depends on who is left out.

    Attributes
    ----------
    set : str or None
        None where the table has no sets.
    question : str
        What was asked.
    conditions : tuple of str
        The condition, or a and b.
    measure : {'win share', 'mean rating', 'mean rank'}
        What the number is; the win share is that of a, or of a motion with its own speech.
    analysed : Number
        As reported.
    as_planned : Number
        By the rules alone that were settled beforehand.
    everyone : Number
        When nobody is excluded.
    """

    set: str | None
    question: str
    conditions: tuple[str, ...]
    measure: str
    analysed: Number
    as_planned: Number
    everyone: Number

    @property
    def is_as_planned(self) -> bool:
        """Whether the rules that were settled beforehand give the same as all rules."""
        # As text, in which a number that does not exist equals another one.
        return str(self.analysed) == str(self.as_planned)


MEASURES: Final[Mapping[str, str]] = MappingProxyType(
    {
        "pairwise": "win share",
        "mismatch": "win share",
        "rating": "mean rating",
        "ranking": "mean rank",
    }
)
"""The headline number of each protocol."""


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
    everyone = dict(_numbers(table, left_out.everyone))
    analysed = dict(_numbers(table, left_out.analysed))
    planned = analysed if left_out.is_as_planned else dict(_numbers(table, left_out.as_planned))
    return tuple(
        Sensitivity(
            set=set_name(table, key[0]),
            question=key[1],
            conditions=key[2],
            measure=MEASURES[table.protocol],
            analysed=analysed.get(key, _NOBODY),
            as_planned=planned.get(key, _NOBODY),
            everyone=number,
        )
        for key, number in everyone.items()
    )


def _numbers(table: AnswerTable, answers: pd.DataFrame) -> Iterator[tuple[Key, Number]]:
    for name, question, part in parts(table, answers):
        for conditions, mean in _MEANS[table.protocol](table, part):
            yield (name, question, conditions), _number(mean)


def _pairs(table: AnswerTable, answers: pd.DataFrame) -> Means:
    """Give the win share of a for every two conditions that were shown side by side."""
    left, right = codes(answers, "left"), codes(answers, "right")
    count = len(table.conditions)
    pairs = np.minimum(left, right) * count + np.maximum(left, right)
    for pair in np.unique(pairs).tolist():
        a, b = divmod(pair, count)
        chosen = pairs == pair
        names = (table.conditions[a], table.conditions[b])
        yield names, _wins(answers[chosen], right[chosen] == a)


def _own_speech(table: AnswerTable, answers: pd.DataFrame) -> Means:
    """Give each condition's share of preferences for its own speech."""
    for condition, own in _by_condition(table, answers):
        yield (condition,), _wins(own, np.asarray(own["right_speech"] == "own", bool))


def _ratings(table: AnswerTable, answers: pd.DataFrame) -> Means:
    """Give each condition's mean rating."""
    for condition, own in _by_condition(table, answers):
        yield (
            (condition,),
            clustered_mean(
                own["value"].to_numpy(np.float64),
                codes(own, "participant"),
                codes(own, "segment"),
                null=math.nan,
                limits=limits_of(table, str(own["question"].iloc[0])),
            ),
        )


def _ranks(table: AnswerTable, answers: pd.DataFrame) -> Means:
    """Give each condition's mean rank."""
    shown = [table.conditions[place] for place in np.unique(codes(answers, "condition"))]
    placed = placements(answers.rename(columns={"value": "rank"}), shown)
    for one in rank_summaries(placed):
        yield (one.condition,), one.mean_rank


def _by_condition(table: AnswerTable, answers: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    shown = codes(answers, "condition")
    for place in np.unique(shown).tolist():
        yield table.conditions[place], answers[shown == place]


def _wins(answers: pd.DataFrame, on_right: NDArray[np.bool_]) -> Estimate:
    found = sided(answers, on_right)
    return clustered_mean(found.wins, found.participants, found.segments)


_MEANS: Final[Mapping[str, Callable[[AnswerTable, pd.DataFrame], Means]]] = MappingProxyType(
    {"pairwise": _pairs, "mismatch": _own_speech, "rating": _ratings, "ranking": _ranks}
)

_NOBODY: Final = Number(
    n=0,
    participants=0,
    estimate=math.nan,
    low=math.nan,
    high=math.nan,
    reason="nobody who answered this is analysed",
)


def _number(mean: Estimate) -> Number:
    return Number(
        n=mean.n,
        participants=mean.participants,
        estimate=mean.estimate,
        low=mean.low,
        high=mean.high,
        reason=mean.reason,
    )
