"""The exclusion rules, each of which judges the facts of one participant, and their outcomes.

It loads without pandas, since the server uses it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

BY_HAND: Final = "researcher"
"""Name of the rule that removes participants whom researchers exclude one by one."""


@dataclass(frozen=True, kw_only=True)
class KnownFacts:
    """What a study knows of a participant that a table of answers does not hold.

    Attributes
    ----------
    trials, settled : int or None
        Trials of the whole study session, and how many of them the participant is done with:
        answered, or said that a video does not play; None where that is not known.
    failed_catch, failed_attention : int or None
        Catch trials and attention checks that were failed; None where there are none, or that is
        not known.
    decided : str
        Why a researcher excluded the participant by hand; empty where nobody did.
    """

    trials: int | None = None
    settled: int | None = None
    failed_catch: int | None = None
    failed_attention: int | None = None
    decided: str = ""


@dataclass(frozen=True, kw_only=True)
class SameAnswer:
    """How alike one participant's answers to one question are.

    Attributes
    ----------
    question : str
        Its name.
    answers : int
        How many were given in main and repeated trials.
    share : float
        The share of the most frequent one, in (0, 1].
    """

    question: str
    answers: int
    share: float


@dataclass(frozen=True, kw_only=True, eq=False)
class ParticipantFacts(KnownFacts):
    """The facts of one participant that rules decide from.

    Attributes
    ----------
    participant : str
        Who.
    marked : str
        Why the table itself excludes the participant; empty where it does not.
    watched : float
        Mean share of the videos that was watched, over the answers of main and repeated trials,
        in [0, 1]; NaN where that is not known.
    seconds : ndarray, shape (N,)
        How long answers of main and repeated trials took, as far as that is known; ascending.
    same_answers : tuple of SameAnswer or None
        One for each question answered; None where the answers to a trial exclude one another,
        so that they are never alike.
    """

    participant: str
    marked: str = ""
    watched: float = math.nan
    seconds: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    same_answers: tuple[SameAnswer, ...] | None = None


Judge = Callable[[ParticipantFacts], str | None]

KEPT: Final = ""
"""The verdict of a rule about a participant whom it keeps."""


@dataclass(frozen=True, kw_only=True)
class RuleOutcome:
    """What one rule did to those who reached it.

    Attributes
    ----------
    rule, description : str
        The rule's name and description.
    reached, removed : int
        Participants whom no earlier rule removed, and those of them whom this one did.
    exploratory : bool
        Whether the rule was set up, or changed, after answers could have been seen.
    remark : str
        Who the rule could not be applied to, and why; empty if it could be applied to all.
    """

    rule: str
    description: str
    reached: int
    removed: int
    exploratory: bool = False
    remark: str = ""


@dataclass(frozen=True, kw_only=True)
class Removed:
    """Whom the rules removed.

    Attributes
    ----------
    rules : tuple of RuleOutcome
        In the order in which they were applied.
    exclusions : dict of str to str
        Each participant removed, and why: rule after rule, by name within each.
    removed_by : dict of str to int
        The place in `rules` of the rule that removed each.
    """

    rules: tuple[RuleOutcome, ...]
    exclusions: dict[str, str]
    removed_by: dict[str, int]


@dataclass(frozen=True, kw_only=True)
class ExclusionRule:
    """One named reason to leave participants out of the analysis.

    Attributes
    ----------
    name : str
        Names the rule in study files and tables.
    description : str
        What removed participants are or did, in words that follow their count.
    judge : callable
        From a participant's facts, why the rule removes them; `KEPT` where it does not, None
        where the facts are missing that it decides from.
    missing : str
        What is not known where `judge` returns None, in words.
    exploratory : bool
        Whether it was set up, or changed, after answers could have been seen.
    """

    name: str
    description: str
    judge: Judge
    missing: str = ""
    exploratory: bool = False

    def as_exploratory(self) -> ExclusionRule:
        """Return the same rule, set up after answers could have been seen."""
        return replace(self, exploratory=True)


def marked() -> ExclusionRule:
    """Return the rule that removes participants marked in the table, for the reason given there."""
    return ExclusionRule(
        name="marked",
        description="marked as excluded in the table",
        judge=lambda facts: facts.marked,
    )


def excluded_by_hand() -> ExclusionRule:
    """Return the rule that removes participants whom a researcher excluded, for that reason.

    It cannot be settled beforehand, so it is always exploratory.
    """
    return ExclusionRule(
        name=BY_HAND,
        description="excluded by a researcher",
        judge=lambda facts: facts.decided,
        exploratory=True,
    )


def incomplete() -> ExclusionRule:
    """Return the rule that removes participants who did not get through all trials.

    A trial whose video would not play counts as done: that is not a fault of the participant.
    """

    def judge(facts: ParticipantFacts) -> str | None:
        if facts.trials is None or facts.settled is None:
            return None
        if not facts.trials:
            return "not begun"
        if facts.settled >= facts.trials:
            return KEPT
        return f"{facts.settled} of {facts.trials} trials answered"

    return ExclusionRule(
        name="incomplete",
        description="did not finish",
        judge=judge,
        missing="who reached the end is known of studies only",
    )


def failed_catch_trials(allowed: int) -> ExclusionRule:
    """Return the rule that removes participants who failed more catch trials than `allowed`.

    A catch trial is failed when any of its questions is not answered in favour of the motion
    that is not flawed.
    """
    return ExclusionRule(
        name="catch",
        description=f"failed {_more_than(allowed, 'catch trial')}",
        judge=lambda facts: _too_many(facts.failed_catch, allowed, "catch trial"),
        missing="there are no catch trials whose correct side is known",
    )


def failed_attention_checks(allowed: int) -> ExclusionRule:
    """Return the rule that removes participants who failed more than `allowed` attention checks.

    A check is failed when any of its questions is not answered as it asks.
    """
    return ExclusionRule(
        name="attention",
        description=f"failed {_more_than(allowed, 'attention check')}",
        judge=lambda facts: _too_many(facts.failed_attention, allowed, "attention check"),
        missing="there are no attention checks that say what they ask for",
    )


def watched_less(below: float) -> ExclusionRule:
    """Return the rule that removes participants who watched less than `below` of the videos.

    It looks at the mean over the answers of main and repeated trials, in [0, 1].
    """

    def judge(facts: ParticipantFacts) -> str | None:
        if math.isnan(facts.watched):
            return None
        if facts.watched >= below:
            return KEPT
        return f"{_percent(facts.watched)} of the videos watched"

    return ExclusionRule(
        name="coverage",
        description=f"watched less than {_percent(below)} of the videos",
        judge=judge,
        missing="how much of the videos was watched is not known",
    )


def answered_too_fast(below: float, share: float) -> ExclusionRule:
    """Return the rule that removes participants who too often answered within `below` seconds.

    Parameters
    ----------
    below : float
        Seconds, above zero.
    share : float
        Share of the answers of main and repeated trials from which it is too often, in (0, 1].
        One half is a rule about the median.
    """

    def judge(facts: ParticipantFacts) -> str | None:
        if not len(facts.seconds):
            return None
        fast = int(np.searchsorted(facts.seconds, below))
        if fast / len(facts.seconds) < share:
            return KEPT
        return f"{fast} of {len(facts.seconds)} answers given in less than {below:g} s"

    return ExclusionRule(
        name="time",
        description=f"gave at least {_percent(share)} of the answers in less than {below:g} s",
        judge=judge,
        missing="how long answers took is not known",
    )


def straight_lined(at_least: float, trials: int) -> ExclusionRule:
    """Return the rule that removes participants who gave nearly always the same answer.

    Parameters
    ----------
    at_least : float
        Share of the most frequent answer among those to one question from which a participant
        is removed, in (0, 1]. The answer is the one chosen on the page: the side, not the
        condition.
    trials : int
        Questions with fewer answers from a participant say nothing about that participant.
    """

    def judge(facts: ParticipantFacts) -> str | None:
        asked = [same for same in facts.same_answers or () if same.answers >= trials]
        if not asked:
            return None
        worst = max(asked, key=lambda same: same.share)
        if worst.share < at_least:
            return KEPT
        return (
            f"the same answer {round(worst.share * worst.answers)} of {worst.answers} times "
            f"to {worst.question}"
        )

    return ExclusionRule(
        name="straight_lining",
        description=f"gave the same answer to at least {_percent(at_least)} of one question "
        f"asked {trials} times or more",
        judge=judge,
        missing=f"no question has {trials} answers that could be alike",
    )


def _too_many(failed: int | None, allowed: int, noun: str) -> str | None:
    if failed is None:
        return None
    return f"{_count(failed, noun)} failed" if failed > allowed else KEPT


def _more_than(allowed: int, noun: str) -> str:
    if allowed:
        return f"more than {_count(allowed, noun)}"
    return f"{'an' if noun[0] == 'a' else 'a'} {noun}"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _percent(share: float) -> str:
    return f"{100 * share:.4g}%"


def apply_rules(
    participants: Sequence[ParticipantFacts], rules: Sequence[ExclusionRule]
) -> Removed:
    """Apply `rules` in order; a participant counts under the first that removes them.

    A participant whom a rule cannot judge stays, and the rule's outcome says so.
    """
    remaining = sorted(participants, key=lambda facts: facts.participant)
    outcomes: list[RuleOutcome] = []
    reasons: dict[str, str] = {}
    removed_by: dict[str, int] = {}
    for place, rule in enumerate(rules):
        judged = [(facts, rule.judge(facts)) for facts in remaining]
        removed = {facts.participant: reason for facts, reason in judged if reason}
        outcomes.append(
            RuleOutcome(
                rule=rule.name,
                description=rule.description,
                reached=len(judged),
                removed=len(removed),
                exploratory=rule.exploratory,
                remark=_remark(rule, len(judged), sum(reason is None for _, reason in judged)),
            )
        )
        reasons |= removed
        removed_by |= dict.fromkeys(removed, place)
        remaining = [facts for facts, reason in judged if not reason]
    return Removed(rules=tuple(outcomes), exclusions=reasons, removed_by=removed_by)


def _remark(rule: ExclusionRule, reached: int, unknown: int) -> str:
    if not unknown:
        return ""
    if unknown == reached:
        return f"cannot be applied: {rule.missing}"
    return f"cannot be applied to {unknown} of {reached} participants, who stay: {rule.missing}"
