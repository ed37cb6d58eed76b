"""What the analysis of a rehearsal recovers of true values, and of each kind of rater."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from scipy.stats import binom

from analysis.results.known_values import (
    KnownDifference,
    KnownValue,
    match_differences,
    match_values,
)
from analysis.stats.clustered_mean import LEVEL, Estimate
from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.monitoring.study_sessions import progress_of_sessions
from studyapp.rehearsal.bookkeeping import Check, Ledger, Person, checks, people
from studyapp.rehearsal.simulation.population import KINDS, UNSOUND, Kind
from studyapp.rehearsal.simulation.truth import read_truth
from studyapp.results.analysed_tasks import analysed_tasks
from studyapp.results.answers import answers_in, snapshot
from studyapp.results.report import task_report
from studyapp.session.served_study import ServedStudy
from studyapp.study.folder import StudyFolder


@dataclass(frozen=True, kw_only=True)
class KindRecovered:
    """The exclusions of one kind of rater.

    Attributes
    ----------
    kind : Kind
        The kind.
    came, completed, analysed : int
        How many took part, completed the study, and are analysed.
    silent : int
        How many gave no answer, and cannot be excluded.
    excluded_by : mapping of rule to int
        How many each rule excludes.
    """

    kind: Kind
    came: int
    completed: int
    analysed: int
    silent: int
    excluded_by: Mapping[str, int]

    @property
    def excluded(self) -> int:
        """How many are excluded."""
        return sum(self.excluded_by.values())

    @property
    def should_be_excluded(self) -> bool:
        """Whether the analysis is better without them."""
        return self.kind in UNSOUND or self.kind == "dropping_out"

    @property
    def missed(self) -> int:
        """How many should be excluded but are analysed."""
        return self.analysed if self.should_be_excluded else 0

    @property
    def wrongly_excluded(self) -> int:
        """How many are excluded although they judge like attentive raters."""
        return 0 if self.should_be_excluded else self.excluded


def kinds_recovered(
    participants: Sequence[Person], analysed: Iterable[str], removed_by: Mapping[str, str]
) -> tuple[KindRecovered, ...]:
    """Return the exclusions of each kind of rater that took part.

    Parameters
    ----------
    participants : sequence of Person
        All participants.
    analysed : iterable of str
        Analysed study sessions.
    removed_by : mapping of study session to rule
        The first rule that excludes each excluded study session.
    """
    kept = set(analysed)
    kinds = []
    for kind in reversed(KINDS):
        members = [person for person in participants if person.rater.kind == kind]
        if not members:
            continue
        numbers = [person.study_session for person in members]
        rules = Counter(removed_by[number] for number in numbers if number in removed_by)
        analysed_count = sum(number in kept for number in numbers)
        kinds.append(
            KindRecovered(
                kind=kind,
                came=len(members),
                completed=sum(person.completed for person in members),
                analysed=analysed_count,
                silent=len(members) - analysed_count - rules.total(),
                excluded_by=dict(sorted(rules.items())),
            )
        )
    return tuple(kinds)


@dataclass(frozen=True, kw_only=True)
class Recovery:
    """What the analysis of a rehearsal recovers.

    Attributes
    ----------
    title : str
        The study's title.
    labels : mapping of str to str
        What the study calls its conditions and comparisons, by name.
    values : tuple of (KnownValue, Estimate)
        Every number that was put in and estimated.
    differences : tuple of KnownDifference
        Which of any two that were compared is found to be the better one.
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
        """The number of intervals."""
        return sum(estimate.has_interval for _, estimate in self.values)

    @property
    def missed(self) -> int:
        """The number of intervals that miss the true value."""
        return self.intervals - sum(estimate.covers(known.value) for known, estimate in self.values)

    @property
    def chance(self) -> float:
        """How often so many intervals miss the true value with a sound design; or none, if none.

        Each interval then misses with probability 1 minus its level (Binomial). Answers of the same
        people to several questions are correlated, which makes many misses at once more common.
        """
        if not self.missed:
            return float(LEVEL**self.intervals)
        return float(binom.sf(self.missed - 1, self.intervals, 1 - LEVEL))

    @property
    def unanswered(self) -> tuple[KnownDifference, ...]:
        """The comparisons whose better condition was not found, those with a wrong sign first."""
        signs = ("wrong", "undecided")
        return tuple(each for sign in signs for each in self.differences if each.sign == sign)


def recover(folder: StudyFolder) -> Recovery:
    """Analyse the rehearsal of `folder` as a report does.

    Raises
    ------
    InputError
        If the study was not rehearsed, or its answers contradict it.
    """
    study = folder.study()
    truth = read_truth(folder.rehearsal_truth)
    served = ServedStudy.read(folder.root).opened_for(rehearsal=True)
    known = truth.expected
    with snapshot(folder, "rehearsal") as session:
        if session is None:
            raise InputError(
                "the study has not been rehearsed",
                where=folder.rehearsal,
                remedy="Run 'motionjury rehearse'",
            )
        answers = answers_in(session, "rehearsal")
        tasks = analysed_tasks(study, answers)
        reports = [task_report(study, task, answers) for task in tasks]
        participants = people(session, truth)
        counted = tuple(
            checks(
                session,
                Ledger(folder.acknowledged).read(),
                participants,
                progress_of_sessions(session, served, Clock().now()),
                completed_in_report=sum(flow.completed or 0 for flow in reports[0].flow),
            )
        )
    removed_by = {
        name: task.left_out.rules[index].rule
        for task in reversed(tasks)
        for name, index in task.left_out.removed_by.items()
    }
    kept = {str(name) for task in tasks for name in task.left_out.kept["participant"].unique()}
    return Recovery(
        title=study.title,
        labels=study.display_names,
        values=match_values(reports, known),
        differences=match_differences(reports, known),
        kinds=kinds_recovered(participants, kept, removed_by),
        checks=counted,
        rules=tuple(rule.description for rule in tasks[0].left_out.rules),
    )
