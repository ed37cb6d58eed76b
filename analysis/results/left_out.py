"""Which participants of a table are left out, and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd

from analysis.exclusions import ExclusionRule, Reasons, RuleOutcome, exclude, failed_catch_trials
from analysis.tables.answers import AnswerTable
from analysis.trial_kinds import ANALYSED_KINDS

MAX_CATCH_FAILURES: Final = 1
"""Failed catch trials that a participant may have, unless told otherwise."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LeftOut:
    """What the rules did.

    Attributes
    ----------
    exclusions : dict of str to str
        Each participant left out, and the reason.
    rules : tuple of RuleOutcome
        In the order in which they were applied.
    kept : DataFrame
        Answers to practice, main and repeated trials of those whom every rule kept.
    analysed, everyone : DataFrame
        Main and repeat answers of those whom every rule kept; of all.
    recruited, attentive : int
        How many participants there are in the table, and how many were kept.
    """

    exclusions: dict[str, str]
    rules: tuple[RuleOutcome, ...]
    kept: pd.DataFrame
    analysed: pd.DataFrame
    everyone: pd.DataFrame
    recruited: int
    attentive: int


def leave_out(table: AnswerTable, max_catch_failures: int = MAX_CATCH_FAILURES) -> LeftOut:
    """Leave out who is marked in the table, then who failed too many catch trials.

    A catch trial is failed when any of its questions is not answered with a weak or strong
    preference for its correct side.
    """
    rules = [_marked(table.marked)] if table.marked else []
    if (table.answers["kind"] == "catch").any():
        rules.append(failed_catch_trials(max_catch_failures))
    found = exclude(_sessions(table), rules)
    exclusions = {one.study_session: one.reason for one in found.exclusions}
    shown = table.shown
    stays = ~shown["participant"].isin(list(exclusions))
    counts = shown["kind"].isin(ANALYSED_KINDS)
    return LeftOut(
        exclusions=exclusions,
        rules=found.outcomes,
        kept=shown[stays].reset_index(drop=True),
        analysed=shown[stays & counts].reset_index(drop=True),
        everyone=shown[counts].reset_index(drop=True),
        recruited=len(table.participants),
        attentive=len(table.participants) - len(exclusions),
    )


def _marked(reasons: Reasons) -> ExclusionRule:
    def apply(responses: pd.DataFrame) -> Reasons:
        present = set(responses["study_session"])
        return {person: reason for person, reason in reasons.items() if person in present}

    return ExclusionRule(name="marked", description="marked as excluded in the table", apply=apply)


def _sessions(table: AnswerTable) -> pd.DataFrame:
    """Return what the rules look at: everybody once, and the answers of catch trials."""
    catch = table.answers[table.answers["kind"] == "catch"]
    everybody = pd.DataFrame({"study_session": list(table.participants), "kind": "main"})
    judged = pd.DataFrame(
        {
            "study_session": catch["participant"].astype(object),
            "kind": "catch",
            "position": _presentations(catch),
            "value": catch["value"] - 3,
            "expected": catch["correct_side"].astype(object),
        }
    )
    return pd.concat([everybody, judged], ignore_index=True).assign(comparison="")


def _presentations(catch: pd.DataFrame) -> pd.Series[int]:
    """Return a number for each presentation: rows that differ in the question alone share it.

    Where the table does not number trials, the second answer to one question about the same
    presentation belongs to its second showing.
    """
    shown = [
        name
        for name in ("participant", "set", "trial", "segment", "left", "right", "condition")
        if name in catch
    ]
    shown += [name for name in ("left_speech", "right_speech", "correct_side") if name in catch]
    codes = pd.DataFrame({name: catch[name].cat.codes for name in [*shown, "question"]})
    codes["showing"] = codes.groupby([*shown, "question"], sort=False).cumcount()
    return pd.Series(
        codes.groupby([*shown, "showing"], sort=False).ngroup().to_numpy(np.int64),
        index=catch.index,
    )
