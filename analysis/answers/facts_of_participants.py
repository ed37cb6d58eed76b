"""The facts about every participant of a table of answers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.answers.columns import ANALYSED_KINDS
from analysis.answers.participant_facts import KnownFacts, ParticipantFacts, SameAnswer
from analysis.answers.quality import straight_lining
from analysis.answers.table import AnswerTable

NOTHING_KNOWN: Final[Mapping[str, KnownFacts]] = MappingProxyType({})

MIDDLE: Final = 3
"""The answer for neither side."""

_SHOWN: Final = (
    *("participant", "set", "trial", "segment", "kind", "left", "right", "condition"),
    *("left_speech", "right_speech", "correct_side"),
)
"""Columns that tell presentations apart, as far as a protocol has them."""


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
    attention = _failed(answers[answers["kind"] == "attention"], _disobedient)
    watched = _mean(analysed, "watched")
    seconds = _times(analysed)
    same = _same_answers(table, analysed)
    participants = []
    for who in table.participants:
        beside = known.get(who)
        participants.append(
            ParticipantFacts(
                participant=who,
                marked=table.marked.get(who, ""),
                decided="" if beside is None else beside.decided,
                trials=None if beside is None else beside.trials,
                settled=None if beside is None else beside.settled,
                failed_catch=_failures(catch, who) if beside is None else beside.failed_catch,
                failed_attention=(
                    _failures(attention, who) if beside is None else beside.failed_attention
                ),
                watched=watched.get(who, math.nan),
                seconds=seconds.get(who, np.zeros(0)),
                same_answers=None if same is None else same.get(who, ()),
            )
        )
    return tuple(participants)


def _failures(failed: Mapping[str, int] | None, who: str) -> int | None:
    """Return how many presentations `who` failed; None where the table judges nobody's."""
    return None if failed is None else failed.get(who, 0)


def _wrong_side(catch: pd.DataFrame) -> NDArray[np.bool_]:
    """Tell which answers do not prefer the correct side, weakly or strongly."""
    towards = np.where(catch["correct_side"].astype(object) == "right", 1, -1)
    return np.asarray((catch["value"].to_numpy() - MIDDLE) * towards <= 0, bool)


def _disobedient(attention: pd.DataFrame) -> NDArray[np.bool_]:
    """Tell which answers are not the one asked for; where none is asked for, any will do."""
    asked = attention["instructed"].to_numpy(np.float64)
    given = attention["value"].to_numpy(np.float64)
    return np.asarray(np.isfinite(asked) & (given != asked), bool)


def _failed(
    answers: pd.DataFrame, wrong: Callable[[pd.DataFrame], NDArray[np.bool_]]
) -> dict[str, int] | None:
    """Return how many presentations each participant failed; one wrong answer is enough."""
    if answers.empty:
        return None
    found = pd.DataFrame(
        {
            "participant": answers["participant"].astype(object),
            "presentation": _presentations(answers),
            "wrong": wrong(answers),
        }
    )
    each = found.groupby("presentation", sort=False).agg(
        participant=("participant", "first"), wrong=("wrong", "any")
    )
    counts = each.groupby("participant", sort=False)["wrong"].sum()
    return {str(who): int(count) for who, count in counts.items()}


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


def _mean(analysed: pd.DataFrame, column: str) -> dict[str, float]:
    means = analysed.groupby("participant", observed=True)[column].mean()
    return {str(who): float(mean) for who, mean in means.items()}


def _times(analysed: pd.DataFrame) -> dict[str, NDArray[np.float64]]:
    """Return how long each participant's answers took, ascending, as far as that is known."""
    known = analysed.loc[analysed["seconds"].notna(), ["participant", "seconds"]]
    return {
        str(who): np.sort(times.to_numpy(np.float64))
        for who, times in known.groupby("participant", observed=True)["seconds"]
    }


def _same_answers(
    table: AnswerTable, analysed: pd.DataFrame
) -> dict[str, tuple[SameAnswer, ...]] | None:
    """Return how alike each participant's answers are; None of rankings, whose ranks differ."""
    if table.protocol == "ranking":
        return None
    found: dict[str, list[SameAnswer]] = {}
    for question in table.questions:
        own = analysed[analysed["question"] == question]
        for line in straight_lining(own):
            found.setdefault(line.participant, []).append(
                SameAnswer(question=question, answers=line.answers, share=line.share)
            )
    return {who: tuple(each) for who, each in found.items()}
