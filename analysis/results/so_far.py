"""What a study that goes on gives so far: how far participants agree, and the headline numbers.

They are those of the report, without its tests: whoever looks before the end is to see sizes and
how wide open they are, and no p.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

import numpy as np
import pandas as pd

from analysis.answers.table import AnswerTable
from analysis.results.agreement import Agreement
from analysis.results.grouping import codes, parts, set_name, shown_conditions
from analysis.results.left_out import LeftOut
from analysis.results.mismatch import mismatch_agreement, mismatch_retest, own_on_right
from analysis.results.pairwise import pairwise_agreement, pairwise_retest
from analysis.results.preference import win_share
from analysis.results.ranking import concordance, placements_of
from analysis.results.rating import limits_of, rating_agreement, rating_retest, scores_of
from analysis.results.sided import sided
from analysis.stats.clustered_mean import Estimate
from analysis.stats.rankings.placements import rank_summaries
from analysis.stats.rating_table import rating_table
from analysis.stats.retest import Retest

Measure = Literal["win_share", "own_speech", "mean_rating", "mean_rank"]


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
    answers, participants : int
        What it rests on.
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
    answers: int
    participants: int
    reason: str
    retest: Retest | None


@dataclass(frozen=True, kw_only=True)
class EstimateSoFar:
    """One headline number.

    Attributes
    ----------
    set : str or None
        None where the study has no sets.
    question : str
        Its name.
    about, against : str
        The condition, and of pairwise comparisons the one that it is compared with, else empty.
    measure : {'win_share', 'own_speech', 'mean_rating', 'mean_rank'}
        What the number is; a win share counts ties one half.
    estimate, low, high : float
        With its 95 % interval, clustered by participant and segment; NaN where there is none.
    answers, participants, segments : int
        What it rests on.
    reason : str
        Why a number is missing.
    """

    set: str | None
    question: str
    about: str
    against: str
    measure: Measure
    estimate: float
    low: float
    high: float
    answers: int
    participants: int
    segments: int
    reason: str


def agreed_so_far(table: AnswerTable, left_out: LeftOut) -> tuple[AgreedSoFar, ...]:
    """Return how far the participants agree whom no rule leaves out, question by question.

    It does not tell what they prefer: opposite answers of everybody give the same.
    """
    if table.protocol == "ranking":
        return tuple(
            _concordance(set_name(table, name), question, answers)
            for name, question, answers in parts(table, left_out.analysed)
        )
    agreement, retest = _AGREED[table.protocol]
    kept = {(name, question): part for name, question, part in parts(table, left_out.kept)}
    return tuple(
        _agreed(set_name(table, name), question, agreement(answers), retest(kept[name, question]))
        for name, question, answers in parts(table, left_out.analysed)
    )


_AGREED: Final = MappingProxyType[
    str, tuple[Callable[[pd.DataFrame], Agreement], Callable[[pd.DataFrame], Retest]]
](
    {
        "pairwise": (pairwise_agreement, pairwise_retest),
        "rating": (rating_agreement, rating_retest),
        "mismatch": (mismatch_agreement, mismatch_retest),
    }
)


def _agreed(of: str | None, question: str, found: Agreement, retest: Retest) -> AgreedSoFar:
    return AgreedSoFar(
        set=of,
        question=question,
        measure="alpha",
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        answers=found.n,
        participants=found.participants,
        reason=found.reason,
        retest=retest,
    )


def _concordance(of: str | None, question: str, answers: pd.DataFrame) -> AgreedSoFar:
    given = placements_of(answers)
    found = concordance(given)
    return AgreedSoFar(
        set=of,
        question=question,
        measure="w",
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        answers=len(given.ranks),
        participants=len(np.unique(given.participants)),
        reason="" if math.isfinite(found.low) else found.reason,
        retest=None,
    )


def estimates_so_far(table: AnswerTable, left_out: LeftOut) -> tuple[EstimateSoFar, ...]:
    """Return the report's headline numbers, in the order of sets, questions and conditions."""
    of_question = _ESTIMATED[table.protocol]
    return tuple(
        one
        for name, question, answers in parts(table, left_out.analysed)
        for one in of_question(table, set_name(table, name), question, answers)
    )


def _compared(
    table: AnswerTable, of: str | None, question: str, answers: pd.DataFrame
) -> Iterator[EstimateSoFar]:
    left, right = codes(answers, "left"), codes(answers, "right")
    count = len(table.conditions)
    pairs = np.minimum(left, right) * count + np.maximum(left, right)
    for pair in np.unique(pairs).tolist():
        a, b = divmod(pair, count)
        own = answers[pairs == pair]
        share = win_share(sided(own, codes(own, "right") == a))
        names = table.conditions[a], table.conditions[b]
        yield _number(of, question, names, "win_share", share)


def _matched(
    table: AnswerTable, of: str | None, question: str, answers: pd.DataFrame
) -> Iterator[EstimateSoFar]:
    for place in np.unique(codes(answers, "condition")).tolist():
        own = answers[codes(answers, "condition") == place]
        share = win_share(sided(own, own_on_right(own)))
        yield _number(of, question, (table.conditions[place], ""), "own_speech", share)


def _rated(
    table: AnswerTable, of: str | None, question: str, answers: pd.DataFrame
) -> Iterator[EstimateSoFar]:
    scores, limits = scores_of(table), limits_of(table, question)
    for one in rating_table(answers, shown_conditions(answers), scores, limits):
        yield _number(of, question, (one.condition, ""), "mean_rating", one)


def _ranked(
    table: AnswerTable, of: str | None, question: str, answers: pd.DataFrame
) -> Iterator[EstimateSoFar]:
    del table
    for one in rank_summaries(placements_of(answers)):
        yield _number(of, question, (one.condition, ""), "mean_rank", one.mean_rank)


def _number(
    of: str | None, question: str, names: tuple[str, str], measure: Measure, found: Estimate
) -> EstimateSoFar:
    about, against = names
    return EstimateSoFar(
        set=of,
        question=question,
        about=about,
        against=against,
        measure=measure,
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        answers=found.n,
        participants=found.participants,
        segments=found.segments,
        reason=found.reason,
    )


_ESTIMATED: Final = MappingProxyType[
    str,
    Callable[[AnswerTable, str | None, str, pd.DataFrame], Iterator[EstimateSoFar]],
](
    {
        "pairwise": _compared,
        "mismatch": _matched,
        "rating": _rated,
        "ranking": _ranked,
    }
)
