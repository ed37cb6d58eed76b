"""What the analysis of a rehearsal finds, beside what was put in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from analysis.results.known_values import (
    KnownDifference,
    KnownValue,
    found_differences,
    found_values,
)
from analysis.results.report import Settings
from analysis.stats.clustered_mean import Estimate
from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.monitoring.study_sessions import progress_of_sessions
from studyapp.rehearsal.ledger import Ledger
from studyapp.rehearsal.people import people
from studyapp.rehearsal.record import read_truth
from studyapp.rehearsal.recovery.bookkeeping import Check, checks
from studyapp.rehearsal.recovery.kinds import KindRecovered, kinds_recovered
from studyapp.results.analysed_tasks import AnalysedTask, analysed_tasks, rules_of
from studyapp.results.answers import answers_in, snapshot
from studyapp.results.task_report import task_report
from studyapp.session.served_study import ServedStudy
from studyapp.study.folder import StudyFolder


@dataclass(frozen=True, kw_only=True)
class Recovery:
    """What came of a rehearsal.

    Attributes
    ----------
    title : str
        The study's.
    seed : int
        The rehearsal's.
    values : tuple of (KnownValue, Estimate)
        Every number that was put in and estimated.
    differences : tuple of KnownDifference
        Of any two that were compared, which is found to be the better one.
    kinds : tuple of KindRecovered
        What became of each kind of rater that came.
    checks : tuple of Check
        What was counted, and how.
    rules : tuple of str
        The study's rules of exclusion, in words.
    """

    title: str
    seed: int
    values: tuple[tuple[KnownValue, Estimate], ...]
    differences: tuple[KnownDifference, ...]
    kinds: tuple[KindRecovered, ...]
    checks: tuple[Check, ...]
    rules: tuple[str, ...]

    @property
    def intervals(self) -> int:
        """How many intervals there are."""
        return sum(found.has_interval for _, found in self.values)

    @property
    def missed(self) -> int:
        """How many of them miss what was put in."""
        return self.intervals - sum(found.covers(known.value) for known, found in self.values)

    @property
    def miscounted(self) -> tuple[Check, ...]:
        """Everything that the study counted wrong."""
        return tuple(check for check in self.checks if not check.agrees)


def recover(folder: StudyFolder) -> Recovery:
    """Analyse the rehearsal of `folder` as a report does, and return what it finds again.

    Raises
    ------
    InputError
        If the study was not rehearsed yet, or its answers contradict it.
    """
    study = folder.study()
    truth = read_truth(folder.rehearsal_truth)
    served = ServedStudy.read(folder.root).opened_for(rehearsal=True)
    known = truth.expected
    with snapshot(folder, "rehearsal") as session:
        if session is None:
            raise InputError(
                "there was no rehearsal yet",
                where=folder.rehearsal,
                remedy="Run 'motionjury rehearse'",
            )
        answers = answers_in(session, "rehearsal")
        tasks = analysed_tasks(study, answers, rules_of(study, answers))
        # Without margins of equivalence or metrics.
        settings = Settings(max_catch_failures=None, margin=None)
        reports = [task_report(study, task, answers, settings=settings) for task in tasks]
        everybody = people(session, truth)
        counted = tuple(
            checks(
                session,
                Ledger(folder.acknowledged).read(),
                everybody,
                progress_of_sessions(session, served, Clock().now()),
                completed_in_report=sum(flow.completed or 0 for flow in reports[0].flow),
            )
        )
    return Recovery(
        title=study.title,
        seed=truth.seed,
        values=found_values(reports, known),
        differences=found_differences(reports, known),
        kinds=kinds_recovered(everybody, _analysed(tasks), _removed_by(tasks)),
        checks=counted,
        rules=tuple(rule.description for rule in tasks[0].left_out.rules),
    )


def _analysed(tasks: Sequence[AnalysedTask]) -> set[str]:
    return {str(who) for task in tasks for who in task.left_out.kept["participant"].unique()}


def _removed_by(tasks: Sequence[AnalysedTask]) -> dict[str, str]:
    """Return the rule that leaves out each participant, in any task."""
    return {
        who: task.left_out.rules[place].rule
        for task in reversed(tasks)
        for who, place in task.left_out.removed_by.items()
    }
