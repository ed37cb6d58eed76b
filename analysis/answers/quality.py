"""How fast and how uniformly participants answered, and the facts that exclusion rules use."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.exclusion_rules import KnownFacts, ParticipantFacts, SameAnswer
from analysis.answers.table import ANALYSED_KINDS, AnswerTable

Floats = NDArray[np.float64]

RELATIVE_SPEED: Final = 2.0
"""A participant this many times as fast as the typical one is too fast (Leiner 2019)."""

ALIKE: Final = 0.9
"""A participant is listed from this share of one answer among all of theirs."""


@dataclass(frozen=True, kw_only=True)
class ResponseTimes:
    """How long answers took.

    Attributes
    ----------
    median, low_quartile, high_quartile : float
        Of the participants' medians, in seconds; NaN without times.
    limit : float
        Half the median: a participant whose median is below it is too fast.
    too_fast : mapping of participant to float
        The medians of those who are.
    n, missing : int
        Answers whose time is known, and is not.
    reason : str
        Why there are no numbers; empty where there are.
    """

    median: float = math.nan
    low_quartile: float = math.nan
    high_quartile: float = math.nan
    limit: float = math.nan
    too_fast: Mapping[str, float]
    n: int
    missing: int
    reason: str = ""


def response_times(seconds: Floats, participants: Sequence[str] | pd.Categorical) -> ResponseTimes:
    """Summarise response times; nobody is excluded by them.

    Parameters
    ----------
    seconds : ndarray, shape (N,)
        Time of each answer; NaN where it is not known.
    participants : sequence of str, shape (N,)
        Who answered.
    """
    times = pd.Series(np.asarray(seconds, np.float64))
    known = times[np.isfinite(times)]
    missing = len(times) - len(known)
    if known.empty:
        return ResponseTimes(too_fast={}, n=0, missing=missing, reason="no response times")
    names = pd.Series(participants)[known.index]
    medians = known.groupby(names, sort=False, observed=True).median()
    low, middle, high = np.quantile(medians.to_numpy(np.float64), [0.25, 0.5, 0.75]).tolist()
    limit = middle / RELATIVE_SPEED
    return ResponseTimes(
        median=middle,
        low_quartile=low,
        high_quartile=high,
        limit=limit,
        too_fast={str(name): float(median) for name, median in medians.items() if median < limit},
        n=len(known),
        missing=missing,
    )


def straight_lining(answers: pd.DataFrame, question: str = "") -> dict[str, SameAnswer]:
    """Measure how often each participant gave the same answer, in the order of appearance.

    Parameters
    ----------
    answers : DataFrame
        Columns `participant` and `value`, as it was chosen on the page (the side, not the
        condition).
    question : str
        What they answer; empty for several questions.
    """
    times = answers.groupby(["participant", "value"], sort=False, observed=True).size()
    each = times.groupby(level=0, sort=False, observed=True)
    return {
        str(name): SameAnswer(question=question, answers=int(total), share=float(most / total))
        for (name, total), most in zip(each.sum().items(), each.max(), strict=True)
    }


@dataclass(frozen=True, kw_only=True)
class StraightLining:
    """Who gives one answer again and again.

    Attributes
    ----------
    limit : float
        Share of the commonest answer from which a participant is listed.
    participants : mapping of participant to float
        That share of those who are.
    """

    limit: float
    participants: Mapping[str, float]


@dataclass(frozen=True, kw_only=True)
class Quality:
    """How all participants answered, the excluded ones included."""

    response_seconds: ResponseTimes
    straight_lining: StraightLining


def quality(everyone: pd.DataFrame) -> Quality:
    """Describe how main and repeated trials were answered.

    Parameters
    ----------
    everyone : DataFrame
        Answers, those of excluded participants included.
    """
    people = pd.Categorical(everyone["participant"])
    lines = straight_lining(everyone.assign(value=everyone["value"].round()))
    return Quality(
        response_seconds=response_times(everyone["seconds"].to_numpy(np.float64), people),
        straight_lining=StraightLining(
            limit=ALIKE,
            participants={name: same.share for name, same in lines.items() if same.share >= ALIKE},
        ),
    )


NOTHING_KNOWN: Final[Mapping[str, KnownFacts]] = MappingProxyType({})

MIDDLE: Final = 3
"""The answer for neither side."""

_SHOWN: Final = (
    *("participant", "set", "trial", "segment", "kind", "left", "right", "condition"),
    *("left_speech", "right_speech", "correct_side"),
)
"""Columns that identify a presentation, where a protocol has them."""


def facts_of(
    table: AnswerTable, known: Mapping[str, KnownFacts] = NOTHING_KNOWN
) -> tuple[ParticipantFacts, ...]:
    """Return the facts about every participant, in the table's order.

    Parameters
    ----------
    table : AnswerTable
        Answers of every kind of trial.
    known : mapping of participant to KnownFacts
        What a study knows beside them; its judgement of catch trials and attention checks
        replaces the table's.
    """
    answers = table.answers
    analysed = answers[answers["kind"].isin(ANALYSED_KINDS)]
    catch = _failed(answers[answers["kind"] == "catch"], _wrong_side)
    attention = _failed(answers[answers["kind"] == "attention"], _disobeyed)
    by_participant = analysed.groupby("participant", observed=True)
    watched = by_participant["watched"].mean().to_dict()
    seconds = {
        str(name): np.sort(times.dropna().to_numpy(np.float64))
        for name, times in by_participant["seconds"]
    }
    same = _same_answers(table, analysed)
    participants = []
    for name in table.participants:
        failures: dict[str, Any] = {
            "failed_catch": None if catch is None else catch.get(name, 0),
            "failed_attention": None if attention is None else attention.get(name, 0),
        }
        participants.append(
            ParticipantFacts(
                participant=name,
                marked=table.marked.get(name, ""),
                watched=watched.get(name, math.nan),
                seconds=seconds.get(name, np.zeros(0)),
                same_answers=None if same is None else same.get(name, ()),
                **failures | (vars(known[name]) if name in known else {}),
            )
        )
    return tuple(participants)


def _wrong_side(catch: pd.DataFrame) -> NDArray[np.bool_]:
    """Tell which answers do not prefer the correct side, weakly or strongly."""
    sign = np.where(catch["correct_side"].astype(object) == "right", 1, -1)
    return np.asarray((catch["value"].to_numpy() - MIDDLE) * sign <= 0, bool)


def _disobeyed(attention: pd.DataFrame) -> NDArray[np.bool_]:
    """Tell which answers are not the one asked for; where none is asked for, any will do."""
    asked = attention["instructed"].to_numpy(np.float64)
    values = attention["value"].to_numpy(np.float64)
    return np.asarray(np.isfinite(asked) & (values != asked), bool)


def _failed(
    answers: pd.DataFrame, wrong: Callable[[pd.DataFrame], NDArray[np.bool_]]
) -> dict[str, int] | None:
    """Return how many presentations each participant failed; one wrong answer is enough."""
    if answers.empty:
        return None
    judged = pd.DataFrame(
        {
            "participant": answers["participant"].astype(object),
            "presentation": _presentations(answers),
            "wrong": wrong(answers),
        }
    )
    failed = judged.groupby(["participant", "presentation"], sort=False)["wrong"].any()
    counts = failed.groupby("participant", sort=False).sum()
    return {str(name): int(count) for name, count in counts.items()}


def _presentations(answers: pd.DataFrame) -> NDArray[np.int64]:
    """Return a number for each presentation: rows that differ in the question alone share it.

    Where the table does not number trials, the second answer to one question about the same
    presentation belongs to its second showing.
    """
    shown = [name for name in _SHOWN if name in answers]
    codes = pd.DataFrame({name: answers[name].cat.codes for name in [*shown, "question"]})
    codes["showing"] = codes.groupby([*shown, "question"], sort=False).cumcount()
    numbers = codes.groupby([*shown, "showing"], sort=False).ngroup()
    return np.asarray(numbers.to_numpy(), np.int64)


def _same_answers(
    table: AnswerTable, analysed: pd.DataFrame
) -> dict[str, tuple[SameAnswer, ...]] | None:
    """Return how alike each participant's answers are; None of rankings, whose ranks differ."""
    if table.protocol == "ranking":
        return None
    by_participant: dict[str, tuple[SameAnswer, ...]] = {}
    for question in table.questions:
        answers = analysed[analysed["question"] == question]
        for name, same in straight_lining(answers, question).items():
            by_participant[name] = (*by_participant.get(name, ()), same)
    return by_participant
