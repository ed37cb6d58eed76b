"""The headline numbers: of what is reported, with and without exclusions, and of answers so far."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final, Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.table import AnswerTable
from analysis.results.agreement import Agreement
from analysis.results.grouping import codes, parts, set_name
from analysis.results.mismatch import mismatch_agreement, mismatch_retest, own_on_right
from analysis.results.net_preference import sided
from analysis.results.pairwise import pairwise_agreement, pairwise_retest
from analysis.results.participants import LeftOut
from analysis.results.preference import win_share
from analysis.results.ranking import concordance, placements_of
from analysis.results.rating import limits_of, rating_agreement, rating_retest
from analysis.stats.clustered_mean import Estimate, clustered_mean
from analysis.stats.rankings.placements import rank_summaries
from analysis.stats.retest import Retest

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


@dataclass(frozen=True, kw_only=True)
class AgreedSoFar:
    """How far participants agree about one question, with one another and with themselves.

    Attributes
    ----------
    set : str or None
        None where the study has no sets.
    question : str
        Its name.
    measure : {'alpha', 'w'}
        Krippendorff's alpha for ordered answers; of rankings, Kendall's W.
    estimate, low, high : float
        With its 95 % interval; NaN where there is none.
    n, participants : int
        Answers (of rankings: orders) and participants that it rests on.
    reason : str
        Why a number is missing.
    retest : Retest or None
        Practice trials against their repeats; None of rankings, which repeat none.
    """

    set: str | None
    question: str
    measure: Literal["alpha", "w"]
    estimate: float
    low: float
    high: float
    n: int
    participants: int
    reason: str
    retest: Retest | None = None


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


def _pairs(table: AnswerTable, answers: pd.DataFrame) -> Estimates:
    """Give the win share of a for every two conditions that were shown side by side."""
    left, right = codes(answers, "left"), codes(answers, "right")
    count = len(table.conditions)
    pairs = np.minimum(left, right) * count + np.maximum(left, right)
    for pair in np.unique(pairs).tolist():
        a, b = divmod(pair, count)
        chosen = pairs == pair
        share = win_share(sided(answers[chosen], right[chosen] == a))
        yield (table.conditions[a], table.conditions[b]), share


def _own_speech(table: AnswerTable, answers: pd.DataFrame) -> Estimates:
    for condition, own in _by_condition(table, answers):
        yield (condition,), win_share(sided(own, own_on_right(own)))


def _ratings(table: AnswerTable, answers: pd.DataFrame) -> Estimates:
    limits = limits_of(table, str(answers["question"].iloc[0]))
    for condition, own in _by_condition(table, answers):
        values, who = own["value"].to_numpy(np.float64), codes(own, "participant")
        mean = clustered_mean(values, who, codes(own, "segment"), null=math.nan, limits=limits)
        yield (condition,), mean


def _ranks(_table: AnswerTable, answers: pd.DataFrame) -> Estimates:
    for one in rank_summaries(placements_of(answers)):
        yield (one.condition,), one.mean_rank


def _by_condition(table: AnswerTable, answers: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    shown: NDArray[np.intp] = codes(answers, "condition")
    for place in np.unique(shown).tolist():
        yield table.conditions[place], answers[shown == place]


_HEADLINES: Final = MappingProxyType[
    str, tuple[Measure, Callable[[AnswerTable, pd.DataFrame], Estimates]]
](
    {
        "pairwise": ("win_share", _pairs),
        "mismatch": ("own_speech", _own_speech),
        "rating": ("mean_rating", _ratings),
        "ranking": ("mean_rank", _ranks),
    }
)


def agreed_so_far(table: AnswerTable, left_out: LeftOut) -> tuple[AgreedSoFar, ...]:
    """Return how far the participants agree whom no rule leaves out, question by question.

    It does not tell what they prefer: opposite answers of everybody give the same.
    """
    kept = {(name, question): part for name, question, part in parts(table, left_out.kept)}
    return tuple(
        AgreedSoFar(
            set=set_name(table, name),
            question=question,
            **_agreed(table.protocol, answers, kept[name, question]),
        )
        for name, question, answers in parts(table, left_out.analysed)
    )


def _agreed(protocol: str, answers: pd.DataFrame, kept: pd.DataFrame) -> dict[str, Any]:
    if protocol == "ranking":
        given = placements_of(answers)
        agreed = concordance(given)
        return {
            "measure": "w",
            "estimate": agreed.estimate,
            "low": agreed.low,
            "high": agreed.high,
            "n": len(given.ranks),
            "participants": len(np.unique(given.participants)),
            "reason": "" if math.isfinite(agreed.low) else agreed.reason,
        }
    agreement, retest = _AGREED[protocol]
    found = agreement(answers)
    names = ("estimate", "low", "high", "n", "participants", "reason")
    return {name: getattr(found, name) for name in names} | {
        "measure": "alpha",
        "retest": retest(kept),
    }


_AGREED: Final = MappingProxyType[
    str, tuple[Callable[[pd.DataFrame], Agreement], Callable[[pd.DataFrame], Retest]]
](
    {
        "pairwise": (pairwise_agreement, pairwise_retest),
        "rating": (rating_agreement, rating_retest),
        "mismatch": (mismatch_agreement, mismatch_retest),
    }
)
