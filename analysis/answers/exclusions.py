"""Applying exclusion rules, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from analysis.answers.exclusion_rules import ExclusionRule
from analysis.answers.participant_facts import ParticipantFacts


@dataclass(frozen=True, kw_only=True)
class RuleOutcome:
    """What one rule did to those who reached it.

    Attributes
    ----------
    rule, description : str
        Of the rule.
    reached, removed : int
        Participants whom no earlier rule removed, and those of them whom this one did.
    exploratory : bool
        Whether the rule was set up, or changed, after answers could have been seen.
    remark : str
        To whom the rule could not be applied, and why; empty where it could to all.
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
    outcomes : tuple of RuleOutcome
        One a rule, in the order of application.
    reasons : dict of str to str
        Each participant removed, and why: rule after rule, by name within each.
    removed_by : dict of str to int
        The place in `outcomes` of the rule that removed each.
    """

    outcomes: tuple[RuleOutcome, ...]
    reasons: dict[str, str]
    removed_by: dict[str, int]


def apply_rules(
    participants: Sequence[ParticipantFacts], rules: Sequence[ExclusionRule]
) -> Removed:
    """Apply `rules` in order; a participant counts under the first that removes them.

    Who cannot be judged by a rule stays, and the rule's outcome says so.
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
    return Removed(outcomes=tuple(outcomes), reasons=reasons, removed_by=removed_by)


def _remark(rule: ExclusionRule, reached: int, unknown: int) -> str:
    if not unknown:
        return ""
    if unknown == reached:
        return f"cannot be applied: {rule.missing}"
    return f"cannot be applied to {unknown} of {reached} participants, who stay: {rule.missing}"
