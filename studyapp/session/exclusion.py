"""Exclusions that are known as soon as a participant has finished."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final, NamedTuple

from analysis.answers.participant_facts import ParticipantFacts
from studyapp.database.tables import StudySession, Trial
from studyapp.study.settings.study import Study

JUDGED: Final = ("catch", "attention")
"""Kinds of trial that can be failed, and the rules that count the failures."""


class JudgedTrial(NamedTuple):
    """As much of a stored catch trial or attention check as `Study.failed` must know."""

    kind: str
    part: str
    conditions: tuple[str, ...]
    expected: int | None
    instructed: int | None


def is_excluded(study: Study, study_session: StudySession) -> bool:
    """Tell whether more catch trials or attention checks were failed than the study allows.

    The analysis finds the same from the answers, and applies all other rules besides; here it
    only decides about the place.
    """
    failed = failures(study, study_session.trials)
    facts = ParticipantFacts(
        participant=str(study_session.id),
        failed_catch=failed["catch"],
        failed_attention=failed["attention"],
    )
    rules = [each.made() for each in study.settled_exclusions if each.rule in JUDGED]
    return any(rule.judge(facts) for rule in rules)


def failures(study: Study, trials: Iterable[Trial]) -> dict[str, int]:
    """Return how many of `trials` were failed, by kind; to leave one out is to fail it."""
    judged = (trial for trial in trials if trial.settled and trial.kind in JUDGED)
    failed = [trial.kind for trial in judged if is_failed(study, trial)]
    return {kind: failed.count(kind) for kind in JUDGED}


def is_failed(study: Study, trial: Trial) -> bool:
    """Tell whether a catch trial or attention check that somebody is done with was failed."""
    if trial.answered_at is None:
        return True
    answers = {(given.question, given.stimulus): given.value for given in trial.responses}
    return study.failed(trial, answers)
