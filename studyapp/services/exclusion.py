"""Exclusions that are known as soon as a participant has finished."""

from __future__ import annotations

from studyapp.definition.study import Study
from studyapp.models import StudySession, Trial


def is_excluded(study: Study, study_session: StudySession) -> bool:
    """Tell whether more catch trials or attention checks were failed than the study allows.

    The analysis finds the same from the answers; here it only decides about the place.
    """
    failed = [trial.kind for trial in study_session.trials if _failed(study, trial)]
    return (
        failed.count("catch") > study.catch.max_failed
        or failed.count("attention") > study.attention.max_failed
    )


def _failed(study: Study, trial: Trial) -> bool:
    """Tell whether a trial was failed; one that was not answered was not."""
    if trial.answered_at is None or trial.kind not in ("catch", "attention"):
        return False
    answers = {(given.question, given.stimulus): given.value for given in trial.responses}
    return study.failed(trial, answers)
