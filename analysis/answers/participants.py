"""Which participants are excluded, by which rule, and the flow from arrival to analysis."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import pandas as pd

from analysis.answers.exclusion_rules import (
    ExclusionRule,
    KnownFacts,
    Removed,
    apply_rules,
    failed_catch_trials,
    marked,
)
from analysis.answers.quality import NOTHING_KNOWN, facts_of
from analysis.answers.table import ANALYSED_KINDS, AnswerTable

MAX_CATCH_FAILURES: Final = 1
"""Failed catch trials that a participant may have, unless told otherwise."""

EVERYBODY: Final = ""
"""The arm of a table, and of a study that has one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LeftOut(Removed):
    """The answers with and without the participants whom the rules exclude.

    Attributes
    ----------
    planned_exclusions : dict of str to str
        Participants excluded by the rules that were settled before answers could be seen, and the
        reason; the same as `exclusions` where no rule is exploratory.
    kept : DataFrame
        Answers to practice, main and repeated trials of those whom every rule kept.
    analysed, everyone : DataFrame
        Main and repeat answers of those whom every rule kept; of all.
    recruited, attentive : int
        How many participants there are in the table, and how many were kept.
    """

    planned_exclusions: dict[str, str]
    kept: pd.DataFrame
    analysed: pd.DataFrame
    everyone: pd.DataFrame
    recruited: int
    attentive: int

    @property
    def is_as_planned(self) -> bool:
        """Whether the rules settled beforehand exclude exactly the same participants."""
        return self.exclusions.keys() == self.planned_exclusions.keys()

    @property
    def as_planned(self) -> pd.DataFrame:
        """Main and repeat answers of participants whom the rules settled beforehand keep."""
        gone = self.everyone["participant"].isin(list(self.planned_exclusions))
        return self.everyone[~gone].reset_index(drop=True)


def leave_out(
    table: AnswerTable,
    rules: Sequence[ExclusionRule],
    *,
    planned: Sequence[ExclusionRule] | None = None,
    known: Mapping[str, KnownFacts] = NOTHING_KNOWN,
) -> LeftOut:
    """Apply `rules` in order; a participant counts under the first that removes them.

    Parameters
    ----------
    table : AnswerTable
        Answers of every kind of trial.
    rules : sequence of ExclusionRule
        In order.
    planned : sequence of ExclusionRule, optional
        Those that were settled before answers could be seen; without them, all of `rules` that
        are not exploratory.
    known : mapping of participant to KnownFacts
        What a study knows beside the table.
    """
    if planned is None:
        planned = [rule for rule in rules if not rule.exploratory]
    participants = facts_of(table, known)
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
    """Return the rules for a platform's table, which has no study file.

    First the marks in the table, then failed catch trials; each only where the table has any.
    """
    catches = bool((table.answers["kind"] == "catch").any())
    return (
        *((marked(),) if table.marked else ()),
        *((failed_catch_trials(max_catch_failures),) if catches else ()),
    )


@dataclass(frozen=True, kw_only=True)
class ArmState:
    """What a study knows of the participants of one arm; None where a table does not.

    Attributes
    ----------
    arm : str
        Its name; `EVERYBODY` where there is one.
    places : int or None
        How many participants it waits for; None for an arm that the study no longer has.
    opened : int or None
        Study sessions begun.
    withdrawn, earlier : int or None
        Those of them whose participants withdrew; that belong to an earlier design of the study
        and are not analysed.
    unwatched : int or None
        Those that ended before, since too many videos were said not to play.
    completed : int or None
        Those of all others that reached the end.
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
        How many gave an answer, and did not withdraw.
    removed : tuple of int
        How many of them each rule removed, in the order of the rules.
    analysed : int
        How many every rule kept.
    """

    answered: int
    removed: tuple[int, ...]
    analysed: int

    @property
    def silent(self) -> int | None:
        """How many came and did not withdraw, but gave no answer."""
        if self.opened is None or self.withdrawn is None or self.earlier is None:
            return None
        return self.opened - self.withdrawn - self.earlier - self.answered


def participant_flow(
    table: AnswerTable,
    left_out: LeftOut,
    arms: Sequence[ArmState] = (),
    arm_of: Mapping[str, str] | None = None,
) -> tuple[Flow, ...]:
    """Count participants arm by arm.

    Parameters
    ----------
    table : AnswerTable
        Who answered.
    left_out : LeftOut
        What the rules did.
    arms : sequence of ArmState
        Of a study; without any, everybody is in one arm.
    arm_of : mapping of str to str
        The arm of each participant.
    """
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
