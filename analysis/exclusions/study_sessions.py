"""Which study sessions are left out of the analysis, by which rule and why.

Rules are applied in order: a study session that a rule removes is not looked at by the next one,
so that the counts add up to a participant flow.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import pandas as pd

from analysis.responses import ANALYSED_KINDS

Reasons = dict[str, str]


@dataclass(frozen=True, kw_only=True)
class ExclusionRule:
    """One named reason to leave a study session out.

    Attributes
    ----------
    name : str
        Names the rule in tables.
    description : str
        What a removed study session is or did, in words that follow its count.
    apply : callable
        Takes the tidy responses, returns the reason for each study session it removes.
    """

    name: str
    description: str
    apply: Callable[[pd.DataFrame], Reasons]


@dataclass(frozen=True, kw_only=True)
class Exclusion:
    """One study session left out of the analysis."""

    study_session: str
    comparison: str
    rule: str
    reason: str


@dataclass(frozen=True, kw_only=True)
class RuleOutcome:
    """How many study sessions one rule removed from those that reached it."""

    rule: str
    description: str
    reached: int
    removed: int


@dataclass(frozen=True, kw_only=True)
class Flow:
    """How many study sessions of one comparison answered, were removed, and are analysed."""

    comparison: str
    answered: int
    removed: tuple[int, ...]
    analysed: int


@dataclass(frozen=True, kw_only=True)
class ExclusionResult:
    """What the rules did, and the answers with and without the excluded study sessions.

    Attributes
    ----------
    outcomes : tuple of RuleOutcome
        One per rule, in the order of application.
    exclusions : tuple of Exclusion
        One per study session left out.
    flow : tuple of Flow
        One per comparison; `Flow.removed` follows the order of `outcomes`.
    analysed : DataFrame
        Main and repeat answers of the study sessions that every rule kept.
    everyone : DataFrame
        Main and repeat answers of all study sessions, the excluded ones included.
    """

    outcomes: tuple[RuleOutcome, ...]
    exclusions: tuple[Exclusion, ...]
    flow: tuple[Flow, ...]
    analysed: pd.DataFrame
    everyone: pd.DataFrame

    @property
    def sessions_answered(self) -> int:
        """Number of study sessions with at least one answer of any kind."""
        return sum(flow.answered for flow in self.flow)

    @property
    def sessions_analysed(self) -> int:
        """Number of study sessions that every rule kept."""
        return sum(flow.analysed for flow in self.flow)


def incomplete_sessions(
    presentations: int, questions: int, completed: Collection[str] = ()
) -> ExclusionRule:
    """Return the rule that removes study sessions with an unanswered question.

    Parameters
    ----------
    presentations : int
        Trials of a whole study session, of all kinds.
    questions : int
        Questions per trial.
    completed : collection of str
        Study sessions known to have reached their end, which stay whatever they lack: a trial
        whose video would not play has no answer, through no fault of the participant.
    """
    needed = presentations * questions

    def apply(responses: pd.DataFrame) -> Reasons:
        answers = responses.groupby("study_session").size()
        return {
            str(session): f"{count} of {needed} answers given"
            for session, count in answers[answers < needed].items()
            if session not in completed
        }

    return ExclusionRule(
        name="incomplete",
        description="unfinished",
        apply=apply,
    )


def failed_catch_trials(allowed: int) -> ExclusionRule:
    """Return the rule that removes study sessions with more than `allowed` failed catch trials.

    A catch trial is failed when any of its questions is not answered with a preference, slight
    or clear, for the expected side.
    """
    trials = f"{allowed} catch {'trial' if allowed == 1 else 'trials'}"

    def apply(responses: pd.DataFrame) -> Reasons:
        failed = count_failed_catch_trials(responses)
        return {
            str(session): f"{count} catch {'trial' if count == 1 else 'trials'} failed"
            for session, count in failed[failed > allowed].items()
        }

    return ExclusionRule(
        name="failed catch trials",
        description=f"failed {f'more than {trials}' if allowed else 'a catch trial'}",
        apply=apply,
    )


def count_failed_catch_trials(responses: pd.DataFrame) -> pd.Series[int]:
    """Return the number of failed catch trials of each study session, 0 for those with none."""
    sessions = pd.Index(responses["study_session"].unique(), name="study_session")
    catch = responses[responses["kind"] == "catch"]
    towards_right = catch["expected"].map({"left": -1, "right": 1}).astype("int64")
    wrong = (catch["value"] * towards_right <= 0).rename("wrong")
    per_trial = wrong.groupby([catch["study_session"], catch["position"]]).any()
    failed = per_trial.groupby("study_session").sum()
    return failed.reindex(sessions, fill_value=0).astype("int64")


def failed_attention_checks(allowed: int) -> ExclusionRule:
    """Return the rule that removes study sessions with more failed attention checks than `allowed`.

    A check is failed when any of its questions is not answered as it asks.
    """
    checks = f"{allowed} attention {'check' if allowed == 1 else 'checks'}"

    def apply(responses: pd.DataFrame) -> Reasons:
        checked = responses[responses["kind"] == "attention"]
        wrong = checked["value"].astype(str) != checked["instructed"]
        per_trial = wrong.groupby([checked["study_session"], checked["position"]]).any()
        failed = per_trial.groupby("study_session").sum()
        return {
            str(session): f"{count} attention {'check' if count == 1 else 'checks'} failed"
            for session, count in failed[failed > allowed].items()
        }

    return ExclusionRule(
        name="failed attention checks",
        description=f"failed {f'more than {checks}' if allowed else 'an attention check'}",
        apply=apply,
    )


def exclude(responses: pd.DataFrame, rules: Sequence[ExclusionRule]) -> ExclusionResult:
    """Apply `rules` in order and return what they did.

    Parameters
    ----------
    responses : DataFrame
        Tidy responses of every kind of trial, as `analysis.responses` returns them.
    rules : sequence of ExclusionRule
        Applied one after the other.
    """
    comparison_of = responses.groupby("study_session")["comparison"].first()
    remaining = responses
    outcomes: list[RuleOutcome] = []
    exclusions: list[Exclusion] = []
    for rule in rules:
        reasons = rule.apply(remaining)
        outcomes.append(
            RuleOutcome(
                rule=rule.name,
                description=rule.description,
                reached=remaining["study_session"].nunique(),
                removed=len(reasons),
            )
        )
        exclusions += [
            Exclusion(
                study_session=session,
                comparison=str(comparison_of[session]),
                rule=rule.name,
                reason=reasons[session],
            )
            for session in sorted(reasons)
        ]
        remaining = remaining[~remaining["study_session"].isin(list(reasons))]
    return ExclusionResult(
        outcomes=tuple(outcomes),
        exclusions=tuple(exclusions),
        flow=_flow(comparison_of, outcomes, exclusions),
        analysed=_analysed_kinds(remaining),
        everyone=_analysed_kinds(responses),
    )


def _analysed_kinds(responses: pd.DataFrame) -> pd.DataFrame:
    return responses[responses["kind"].isin(ANALYSED_KINDS)].reset_index(drop=True)


def _flow(
    comparison_of: pd.Series[str],
    outcomes: Sequence[RuleOutcome],
    exclusions: Sequence[Exclusion],
) -> tuple[Flow, ...]:
    flows: list[Flow] = []
    for comparison in sorted(comparison_of.unique()):
        answered = int((comparison_of == comparison).sum())
        removed = tuple(
            sum(e.comparison == comparison and e.rule == outcome.rule for e in exclusions)
            for outcome in outcomes
        )
        flows.append(
            Flow(
                comparison=str(comparison),
                answered=answered,
                removed=removed,
                analysed=answered - sum(removed),
            )
        )
    return tuple(flows)
