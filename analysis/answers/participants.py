"""Participants: their facts, which rule excludes whom, their flow, and how they answered."""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd

from analysis.answers.exclusion_rules import (
    ExclusionRule,
    KnownFacts,
    ParticipantFacts,
    Removed,
    SameAnswer,
    apply_rules,
    failed_catch_trials,
    marked,
)
from analysis.answers.table import ANALYSED_KINDS, AnswerTable
from motion.arrays import Bools, Ints

MAX_CATCH_FAILURES: Final = 1
"""Failed catch trials that a participant may have by default."""

EVERYBODY: Final = ""
"""The arm of a table, and of a study with a single arm."""

RELATIVE_SPEED: Final = 2.0
"""A participant this many times as fast as the typical one is too fast (Leiner 2019)."""

ALIKE: Final = 0.9
"""A participant is listed if one answer makes up at least this share of all of theirs."""

MIDDLE: Final = 3
"""The answer that prefers neither side."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LeftOut(Removed):
    """The answers with and without the participants whom the rules exclude.

    Attributes
    ----------
    planned_exclusions : dict of str to str
        Why the rules settled before answers could be seen exclude each participant; equal to
        `exclusions` if no rule is exploratory.
    kept : DataFrame
        Answers of the kept participants in practice, main and repeated trials.
    analysed, everyone : DataFrame
        Answers in main and repeated trials: of the kept participants, and of all.
    recruited, attentive : int
        Number of participants in the table, and of those kept.
    """

    planned_exclusions: dict[str, str]
    kept: pd.DataFrame
    analysed: pd.DataFrame
    everyone: pd.DataFrame
    recruited: int
    attentive: int

    @property
    def is_as_planned(self) -> bool:
        """Whether the rules settled in advance exclude exactly the same participants."""
        return self.exclusions.keys() == self.planned_exclusions.keys()

    @property
    def as_planned(self) -> pd.DataFrame:
        """Answers in main and repeated trials of those kept by the rules settled in advance."""
        excluded = self.everyone["participant"].isin(list(self.planned_exclusions))
        return self.everyone[~excluded].reset_index(drop=True)


def leave_out(
    table: AnswerTable,
    rules: Sequence[ExclusionRule],
    *,
    planned: Sequence[ExclusionRule] | None = None,
    known: Mapping[str, KnownFacts] | None = None,
) -> LeftOut:
    """Apply `rules` in order; a participant counts under the first that removes them.

    `planned` are the rules settled before answers could be seen; by default, those that are not
    exploratory. `known` holds the facts that a study knows beyond the table.
    """
    if planned is None:
        planned = [rule for rule in rules if not rule.exploratory]
    participants = facts_of(table, known or {})
    removed = apply_rules(participants, rules)
    shown = table.shown
    stays = ~shown["participant"].isin(list(removed.exclusions))
    counts = shown["kind"].isin(ANALYSED_KINDS)
    return LeftOut(
        **vars(removed),
        planned_exclusions=apply_rules(participants, planned).exclusions,
        kept=shown[stays].reset_index(drop=True),
        analysed=shown[stays & counts].reset_index(drop=True),
        everyone=shown[counts].reset_index(drop=True),
        recruited=len(table.participants),
        attentive=len(table.participants) - len(removed.exclusions),
    )


def table_rules(
    table: AnswerTable, max_catch_failures: int = MAX_CATCH_FAILURES
) -> tuple[ExclusionRule, ...]:
    """Return the rules for a platform's table: its marks and failed catch trials, if it has any."""
    catches = bool((table.answers["kind"] == "catch").any())
    return (
        *((marked(),) if table.marked else ()),
        *((failed_catch_trials(max_catch_failures),) if catches else ()),
    )


@dataclass(frozen=True, kw_only=True)
class ArmState:
    """What a study knows about the participants of one arm; None for a table.

    Attributes
    ----------
    arm : str
        The arm's name; `EVERYBODY` if it is the only one.
    places : int or None
        Participants planned for the arm; None for an arm that the study no longer has.
    opened : int or None
        Study sessions begun.
    withdrawn, earlier : int or None
        Sessions whose participants withdrew, and sessions of an earlier design of the study, which
        are not analysed.
    unwatched : int or None
        Sessions that ended early because too many videos were reported not to play.
    completed : int or None
        The other sessions that reached the end.
    """

    arm: str
    places: int | None = None
    opened: int | None = None
    withdrawn: int | None = None
    earlier: int | None = None
    unwatched: int | None = None
    completed: int | None = None


@dataclass(frozen=True, kw_only=True)
class Flow(ArmState):
    """The participants of one arm, from their arrival to the analysis.

    Attributes
    ----------
    answered : int
        Participants who answered and did not withdraw.
    removed : tuple of int
        How many of them each rule removed, in the rules' order.
    analysed : int
        How many of them every rule kept.
    """

    answered: int
    removed: tuple[int, ...]
    analysed: int

    @property
    def silent(self) -> int | None:
        """Number of participants who came and did not withdraw, but gave no answer."""
        if self.opened is None or self.withdrawn is None or self.earlier is None:
            return None
        return self.opened - self.withdrawn - self.earlier - self.answered


def participant_flow(
    table: AnswerTable,
    left_out: LeftOut,
    arms: Sequence[ArmState] = (),
    arm_of: Mapping[str, str] | None = None,
) -> tuple[Flow, ...]:
    """Count participants arm by arm; without `arms`, all are in one."""
    arm_of = arm_of or {}
    answered = Counter(arm_of.get(name, EVERYBODY) for name in table.participants)
    removed = Counter(
        (arm_of.get(name, EVERYBODY), rule) for name, rule in left_out.removed_by.items()
    )
    states = {state.arm: state for state in arms}
    flows = []
    for arm in dict.fromkeys((*states, *answered)) or (EVERYBODY,):
        counts = tuple(removed[arm, rule] for rule in range(len(left_out.rules)))
        flows.append(
            Flow(
                **vars(states.get(arm, ArmState(arm=arm))),
                answered=answered[arm],
                removed=counts,
                analysed=answered[arm] - sum(counts),
            )
        )
    return tuple(flows)


_SHOWN: Final = (
    *("participant", "set", "trial", "segment", "kind", "left", "right", "condition"),
    *("left_speech", "right_speech", "correct_side"),
)
"""Columns that identify a presentation, if the protocol has them."""


def facts_of(table: AnswerTable, known: Mapping[str, KnownFacts]) -> tuple[ParticipantFacts, ...]:
    """Return the facts about every participant, in the table's order.

    A study's own judgement of catch trials and attention checks replaces the table's.
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
        facts = KnownFacts(
            failed_catch=None if catch is None else catch.get(name, 0),
            failed_attention=None if attention is None else attention.get(name, 0),
        )
        participants.append(
            ParticipantFacts(
                participant=name,
                marked=table.marked.get(name, ""),
                watched=watched.get(name, math.nan),
                seconds=seconds.get(name, np.zeros(0)),
                same_answers=None if same is None else same.get(name, ()),
                **vars(known.get(name, facts)),
            )
        )
    return tuple(participants)


def _wrong_side(catch: pd.DataFrame) -> Bools:
    """Return which answers prefer the correct side neither weakly nor strongly."""
    sign = np.where(catch["correct_side"].astype(object) == "right", 1, -1)
    return np.asarray((catch["value"].to_numpy() - MIDDLE) * sign <= 0, bool)


def _disobeyed(attention: pd.DataFrame) -> Bools:
    """Return which answers differ from the instructed one, if there is one."""
    instructed = attention["instructed"].to_numpy(np.float64)
    values = attention["value"].to_numpy(np.float64)
    return np.asarray(np.isfinite(instructed) & (values != instructed), bool)


def _failed(answers: pd.DataFrame, wrong: Callable[[pd.DataFrame], Bools]) -> dict[str, int] | None:
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


def _presentations(answers: pd.DataFrame) -> Ints:
    """Return the number of each row's presentation; its rows differ only in the question.

    Without trial numbers, a second answer to a question belongs to a second showing.
    """
    shown = [name for name in _SHOWN if name in answers]
    codes = pd.DataFrame({name: answers[name].cat.codes for name in [*shown, "question"]})
    codes["showing"] = codes.groupby([*shown, "question"], sort=False).cumcount()
    numbers = codes.groupby([*shown, "showing"], sort=False).ngroup()
    return np.asarray(numbers.to_numpy(), np.int64)


def _same_answers(
    table: AnswerTable, analysed: pd.DataFrame
) -> dict[str, tuple[SameAnswer, ...]] | None:
    """Return each participant's most frequent answers; None for rankings, whose ranks differ."""
    if table.protocol == "ranking":
        return None
    by_participant: dict[str, tuple[SameAnswer, ...]] = {}
    for question in table.questions:
        answers = analysed[analysed["question"] == question]
        for name, same in _most_frequent(answers, question).items():
            by_participant[name] = (*by_participant.get(name, ()), same)
    return by_participant


def _most_frequent(answers: pd.DataFrame, question: str = "") -> dict[str, SameAnswer]:
    """Return how often each participant gave the same answer, in the order of appearance."""
    times = answers.groupby(["participant", "value"], sort=False, observed=True).size()
    each = times.groupby(level=0, sort=False, observed=True)
    return {
        str(name): SameAnswer(question=question, answers=int(total), share=float(most / total))
        for (name, total), most in zip(each.sum().items(), each.max(), strict=True)
    }


@dataclass(frozen=True, kw_only=True)
class ResponseTimes:
    """How long answers took.

    Attributes
    ----------
    median, low_quartile, high_quartile : float
        Quartiles of the participants' medians, in seconds; NaN without times.
    limit : float
        Half the median: a participant whose median is below it is too fast.
    too_fast : mapping of participant to float
        The medians of the participants who are too fast.
    n, missing : int
        Answers with a known time, and without.
    reason : str
        Why there are no numbers; empty if there are.
    """

    median: float = math.nan
    low_quartile: float = math.nan
    high_quartile: float = math.nan
    limit: float = math.nan
    too_fast: Mapping[str, float]
    n: int
    missing: int
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class StraightLining:
    """Participants who give one answer again and again.

    Attributes
    ----------
    limit : float
        Share of the most frequent answer from which a participant is listed.
    participants : mapping of participant to float
        The share of each participant listed.
    """

    limit: float
    participants: Mapping[str, float]


@dataclass(frozen=True, kw_only=True)
class Quality:
    """How all participants answered, the excluded ones included."""

    response_seconds: ResponseTimes
    straight_lining: StraightLining


def quality(everyone: pd.DataFrame) -> Quality:
    """Describe how all participants answered main and repeated trials; this excludes nobody."""
    lines = _most_frequent(everyone.assign(value=everyone["value"].round()))
    return Quality(
        response_seconds=_response_times(everyone),
        straight_lining=StraightLining(
            limit=ALIKE,
            participants={name: same.share for name, same in lines.items() if same.share >= ALIKE},
        ),
    )


def _response_times(answers: pd.DataFrame) -> ResponseTimes:
    known = answers[np.isfinite(answers["seconds"])]
    missing = len(answers) - len(known)
    if known.empty:
        return ResponseTimes(too_fast={}, n=0, missing=missing, reason="no response times")
    medians = known.groupby("participant", sort=False, observed=True)["seconds"].median()
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
