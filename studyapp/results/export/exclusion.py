"""Who is left out of the analysis, as columns of exported tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import pandas as pd

from analysis.answers.exclusion_rules import BY_HAND, RuleOutcome
from motion.errors import InputError
from studyapp.results.analysed_tasks import AnalysedTask, analysed_tasks, rules_of
from studyapp.results.answer_table import PARTS_OF
from studyapp.results.stored_answers import Answers
from studyapp.study.settings.study import Study

KEPT: Final[Mapping[str, object]] = {
    "excluded": False,
    **dict.fromkeys(("exclusion_rule", "exclusion_kind", "exclusion_reason"), ""),
}


@dataclass(frozen=True, kw_only=True)
class Judged:
    """What the rules of a study say of each participant.

    Attributes
    ----------
    by_part : mapping of str to mapping
        By part of the study ('' where all parts are judged together): by study session, the
        columns about exclusion. Study sessions that the rules were not applied to are not there.
    remark : str
        Why the rules were applied to nobody, as a sentence; empty where they were.
    """

    by_part: Mapping[str, Mapping[str, Mapping[str, object]]] = field(default_factory=dict)
    remark: str = ""

    def mark_answers(self, answers: pd.DataFrame) -> pd.DataFrame:
        """Return `answers` with the columns about exclusion; of a task, by its own rules."""
        return _marked(
            answers,
            [
                self._of(str(who), str(part))
                for who, part in zip(answers["study_session"], answers["part"], strict=True)
            ],
        )

    def mark_participants(self, participants: pd.DataFrame) -> pd.DataFrame:
        """Return `participants` with the same columns: of a task that leaves them out, if any."""
        found = []
        for who in participants["study_session"].astype(str):
            judged = [columns[who] for columns in self.by_part.values() if who in columns]
            found.append(next((one for one in judged if one["excluded"]), next(iter(judged), {})))
        return _marked(participants, found)

    def _of(self, who: str, part: str) -> Mapping[str, object]:
        own = self.by_part.get(part, self.by_part.get("", {}))
        return own.get(who, {})


def judge(study: Study, answers: Answers) -> Judged:
    """Apply the rules of `study`; what cannot be judged is exported all the same."""
    rules = rules_of(study, answers)
    try:
        tasks = analysed_tasks(study, answers, rules)
    except InputError as error:
        return Judged(remark=f"The exclusion rules could not be applied: {error}")
    if len(tasks) == 1:
        return Judged(by_part={"": _of_task(tasks[0])})
    return Judged(by_part={PARTS_OF[task.protocol]: _of_task(task) for task in tasks})


def _of_task(task: AnalysedTask) -> dict[str, Mapping[str, object]]:
    left_out = task.left_out
    return {
        who: {
            "excluded": True,
            "exclusion_rule": left_out.rules[left_out.removed_by[who]].rule,
            "exclusion_kind": _kind(left_out.rules[left_out.removed_by[who]]),
            "exclusion_reason": left_out.exclusions[who],
        }
        if who in left_out.exclusions
        else KEPT
        for who in map(str, task.table.participants)
    }


def _kind(rule: RuleOutcome) -> str:
    if rule.rule == BY_HAND:
        return "by hand"
    return "exploratory" if rule.exploratory else "planned"


def _marked(frame: pd.DataFrame, found: Sequence[Mapping[str, object]]) -> pd.DataFrame:
    return frame.assign(
        **{
            name: pd.Series([one.get(name) for one in found], index=frame.index, dtype=object)
            for name in KEPT
        }
    )
