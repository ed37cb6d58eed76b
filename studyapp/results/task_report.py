"""The results of one task of a study; what reads agreement alone does not load this."""

from __future__ import annotations

from importlib import metadata
from typing import Any

from analysis.results.report import Settings, Source, TableReport, analyse_answers
from studyapp.results.analysed_tasks import ANSWERS, AnalysedTask
from studyapp.results.report_arms import arm_of_each, arm_states
from studyapp.results.stored_answers import Answers
from studyapp.study.settings.study import Study


def task_report(
    study: Study,
    task: AnalysedTask,
    answers: Answers,
    *,
    settings: Settings,
    sha256: str = "",
    **more: Any,
) -> TableReport:
    """Return the results of one task.

    Parameters
    ----------
    sha256 : str
        Of the table of its answers, where that is written.
    **more
        As for `analysis.results.report.analyse_answers`.
    """
    stored = answers.stored
    return analyse_answers(
        task.table,
        task.left_out,
        source=Source(file=ANSWERS, sha256=sha256, motionjury=metadata.version("motionjury")),
        settings=settings,
        arms=() if stored is None else arm_states(study, stored),
        arm_of={} if stored is None else arm_of_each(study, stored.study_sessions),
        **more,
    )
