"""The exclusion rules, each of which judges one participant's facts, and their outcomes.

This module loads without pandas, because the server uses it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from motion.arrays import Floats

BY_HAND: Final = "researcher"
"""Name of the rule that removes participants whom researchers exclude one by one."""


@dataclass(frozen=True, kw_only=True)
class KnownFacts:
    """Facts about a participant that a study knows and a table of answers lacks.

    Attributes
    ----------
    trials, settled : int or None
        Trials of the whole study session, and how many of them are done: answered, or skipped
        because a video does not play. None if unknown.
    failed_catch, failed_attention : int or None
        Failed catch trials and attention checks; None if there are none, or if unknown.
    decided : str
        Why a researcher excluded the participant by hand; empty if nobody did.
    """

    trials: int | None = None
    settled: int | None = None
    failed_catch: int | None = None
    failed_attention: int | None = None
    decided: str = ""


@dataclass(frozen=True, kw_only=True)
class SameAnswer:
    """How often one participant gave the same answer to one question.

    Attributes
    ----------
    question : str
        The question's name.
    answers : int
        The participant's answers in main and repeated trials.
    share : float
        Share of the most frequent answer, in (0, 1].
    """

    question: str
    answers: int
    share: float


@dataclass(frozen=True, kw_only=True, eq=False)
class ParticipantFacts(KnownFacts):
    """The facts by which rules judge one participant.

    Attributes
    ----------
    participant : str
        The participant's name in the table.
    marked : str
        Why the table itself excludes the participant; empty if it does not.
    watched : float
        Share of the videos that was watched, in [0, 1], averaged over the answers in main and
        repeated trials; NaN if unknown.
    seconds : ndarray, shape (N,)
        The known response times of main and repeated trials, in ascending order.
    same_answers : tuple of SameAnswer or None
        One for each question answered; None if the answers to a trial always differ, as in a
        ranking.
    """

    participant: str
    marked: str = ""
    watched: float = math.nan
    seconds: Floats = field(default_factory=lambda: np.zeros(0))
    same_answers: tuple[SameAnswer, ...] | None = None


Judge = Callable[[ParticipantFacts], str | None]

KEPT: Final = ""
"""A rule's verdict on a participant whom it keeps."""


@dataclass(frozen=True, kw_only=True)
class RuleOutcome:
    """The outcome of one rule.

    Attributes
    ----------
    rule, description : str
        The rule's name and description.
    reached, removed : int
        Participants whom no earlier rule removed, and how many of them this rule removed.
    exploratory : bool
        Whether the rule was set up, or changed, after answers could have been seen.
    remark : str
        To how many participants the rule could not be applied, and why; empty if to none.
    """

    rule: str
    description: str
    reached: int
    removed: int
    exploratory: bool = False
    remark: str = ""


@dataclass(frozen=True, kw_only=True)
class Removed:
    """The participants whom the rules removed.

    Attributes
    ----------
    rules : tuple of RuleOutcome
        The outcomes, in the order in which the rules were applied.
    exclusions : dict of str to str
        Why each participant was removed; ordered by rule, then by participant.
    removed_by : dict of str to int
        Index in `rules` of the rule that removed each participant.
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
        A description of removed participants, in words that follow their count.
    judge : callable
        Returns why the rule removes a participant with these facts; `KEPT` if it does not, None if
        it lacks the facts to decide.
    missing : str
        The missing facts in words, for when `judge` returns None.
    exploratory : bool
        Whether the rule was set up, or changed, after answers could have been seen.
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

    It cannot be settled in advance, so it is always exploratory.
    """
    return ExclusionRule(
        name=BY_HAND,
        description="excluded by a researcher",
        judge=lambda facts: facts.decided,
        exploratory=True,
    )


def incomplete() -> ExclusionRule:
    """Return the rule that removes participants who did not finish all trials.

    A trial whose video would not play counts as done: that is not the participant's fault.
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
        missing="only a study records who reached the end",
    )


def failed_catch_trials(allowed: int) -> ExclusionRule:
    """Return the rule that removes participants who failed more catch trials than `allowed`.

    A catch trial is failed when any of its questions is not answered in favour of the unflawed
    motion.
    """
    return ExclusionRule(
        name="catch",
        description=f"failed {_more_than(allowed, 'catch trial')}",
        judge=lambda facts: _too_many(facts.failed_catch, allowed, "catch trial"),
        missing="there are no catch trials whose correct side is known",
    )


def failed_attention_checks(allowed: int) -> ExclusionRule:
    """Return the rule that removes participants who failed more than `allowed` attention checks.

    A check is failed when any of its questions is not answered as instructed.
    """
    return ExclusionRule(
        name="attention",
        description=f"failed {_more_than(allowed, 'attention check')}",
        judge=lambda facts: _too_many(facts.failed_attention, allowed, "attention check"),
        missing="no attention check states the answer that it asks for",
    )


def watched_less(below: float) -> ExclusionRule:
    """Return the rule that removes participants who watched less than `below` of the videos.

    The share, in [0, 1], is averaged over the answers in main and repeated trials.
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
        A participant is removed from this share of fast answers on, in (0, 1], among those in main
        and repeated trials. At one half it is a rule about the median.
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
    """Return the rule that removes participants who nearly always gave the same answer.

    Parameters
    ----------
    at_least : float
        A participant is removed from this share of the most frequent answer to one question on, in
        (0, 1]. An answer is what was chosen on the page: a side, not a condition.
    trials : int
        A question that a participant answered fewer times is not judged.
    """

    def judge(facts: ParticipantFacts) -> str | None:
        judged = [same for same in facts.same_answers or () if same.answers >= trials]
        if not judged:
            return None
        worst = max(judged, key=lambda same: same.share)
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
