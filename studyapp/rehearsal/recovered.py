"""What the analysis of a rehearsal finds, beside the true values, and of each kind of people."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
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
from studyapp.rehearsal.bookkeeping import Check, Ledger, Person, checks, people
from studyapp.rehearsal.record import read_truth
from studyapp.rehearsal.simulation.population import KINDS, UNSOUND, Kind
from studyapp.results.analysed_tasks import AnalysedTask, analysed_tasks
from studyapp.results.answers import answers_in, snapshot
from studyapp.results.report import task_report
from studyapp.session.served_study import ServedStudy
from studyapp.study.folder import StudyFolder


@dataclass(frozen=True, kw_only=True)
class KindRecovered:
    """What the analysis makes of one kind of rater.

    Attributes
    ----------
    kind : Kind
        Which.
    came, completed, analysed : int
        How many began, reached the end, and are analysed.
    silent : int
        How many gave no answer, so that there is nothing of theirs to leave out.
    excluded_by : mapping of rule to int
        How many each rule leaves out.
    """

    kind: Kind
    came: int
    completed: int
    analysed: int
    silent: int
    excluded_by: Mapping[str, int]

    @property
    def excluded(self) -> int:
        """How many are left out by any rule."""
        return sum(self.excluded_by.values())

    @property
    def should_be_left_out(self) -> bool:
        """Whether an analysis is better off without them."""
        return self.kind in UNSOUND or self.kind == "dropping_out"

    @property
    def missed(self) -> int:
        """How many are analysed that should not be."""
        return self.analysed if self.should_be_left_out else 0

    @property
    def wrongly_excluded(self) -> int:
        """How many are left out that judged as the attentive do, and finished."""
        return 0 if self.should_be_left_out else self.excluded


def kinds_recovered(
    everybody: Sequence[Person], analysed: Iterable[str], removed_by: Mapping[str, str]
) -> tuple[KindRecovered, ...]:
    """Return what became of each kind that came.

    Parameters
    ----------
    everybody : sequence of Person
        All who began.
    analysed : iterable of str
        Study sessions that are analysed.
    removed_by : mapping of study session to rule
        Those who are left out, and the first rule that did it.
    """
    kept = set(analysed)
    found = []
    for kind in reversed(KINDS):
        own = [person for person in everybody if person.rater.kind == kind]
        if not own:
            continue
        numbers = [person.study_session for person in own]
        rules = Counter(removed_by[number] for number in numbers if number in removed_by)
        among = sum(number in kept for number in numbers)
        found.append(
            KindRecovered(
                kind=kind,
                came=len(own),
                completed=sum(person.completed for person in own),
                analysed=among,
                silent=len(own) - among - rules.total(),
                excluded_by=dict(sorted(rules.items())),
            )
        )
    return tuple(found)


@dataclass(frozen=True, kw_only=True)
class Recovery:
    """What came of a rehearsal.

    Attributes
    ----------
    title : str
        The study's.
    labels : mapping of str to str
        What the study calls its conditions and comparisons, by name.
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
    labels: Mapping[str, str]
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
        """How many of them miss the true value."""
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
        tasks = analysed_tasks(study, answers)
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
        labels=study.display_names,
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
