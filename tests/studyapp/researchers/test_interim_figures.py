"""Figures are kept in the database: computed once, by one process, and no more often than said."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from sqlalchemy import delete

from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables.researchers import InterimFigures
from studyapp.researchers.audit import StudyState
from studyapp.researchers.exclusion_decisions import decide_exclusion
from studyapp.researchers.interim_figures import (
    ABANDONED_AFTER,
    MIN_INTERVALS,
    TIMEOUT_SECONDS,
    Document,
    FigureKind,
    FigureProcess,
    StoredFigures,
    stored_figures,
)
from studyapp.results.looks import figures_so_far
from studyapp.side_process import SideProcessError
from studyapp.study.folder import StudyFolder
from tests.support.in_process_figures import InProcessFigures
from tests.support.servers.both_databases import BOTH
from tests.support.studies.answered_study import answer_study
from tests.support.studies.taking_part_steps import Participant, SetClock

REST = MIN_INTERVALS["results"].total_seconds()
Ask = Callable[[], StoredFigures]


@dataclass(frozen=True)
class CountedFigures(InProcessFigures):
    """Figures that say how often they were computed, when a test has them computed."""

    computed: list[FigureKind] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)

    def compute(self, what: FigureKind, *, seconds: float = TIMEOUT_SECONDS) -> str:
        if self.problems:
            raise SideProcessError(self.problems.pop())
        self.computed.append(what)
        return f"{what} {len(self.computed)}"


@pytest.fixture
def figures(tmp_path: Path) -> CountedFigures:
    return CountedFigures(tmp_path, "")


@pytest.fixture
def comer(participant: Participant) -> Participant:
    """Return a participant who has answered one trial."""
    participant.take_trial()
    return participant


@pytest.fixture
def ask(opened: Database, clock: SetClock, comer: Participant, figures: CountedFigures) -> Ask:
    return lambda: stored_figures(opened, clock, "results", figures)


@BOTH
def test_figures_are_recomputed_only_after_a_change_and_a_pause(
    clock: SetClock, comer: Participant, figures: CountedFigures, ask: Ask
) -> None:
    first, second = ask(), ask()
    assert (first.document, first.is_computing, second.is_computing) == ("", True, True)
    assert figures.work() == 1
    current = ask()
    assert current.document == "results 1" and current.is_current and not current.is_computing
    clock.advance(seconds=REST + 1)
    assert ask().is_current and figures.work() == 0

    comer.take_trial()
    old = ask()
    assert (old.document, old.is_current, old.is_computing) == ("results 1", False, True)
    figures.work()
    comer.take_trial()
    assert (ask().document, ask().is_current, figures.work()) == ("results 2", False, 0)
    clock.advance(seconds=REST + 1)
    assert (ask().is_computing, figures.work(), ask().document) == (True, 1, "results 3")


def test_a_lost_process_is_replaced_after_a_while(
    clock: SetClock, figures: CountedFigures, ask: Ask
) -> None:
    ask()
    figures.begun.clear()
    ask()
    assert figures.begun == []

    clock.advance(seconds=ABANDONED_AFTER.total_seconds() + 1)
    ask()

    assert (figures.work(), ask().document) == (1, "results 1")


def test_a_failure_is_reported_keeps_earlier_results_and_is_retried(
    clock: SetClock, comer: Participant, figures: CountedFigures, ask: Ask
) -> None:
    found = []
    for problems in ([], ["It took too long."], []):
        figures.problems.extend(problems)
        ask()
        figures.work()
        found.append((ask().document, ask().problem))
        comer.take_trial()
        clock.advance(minutes=2)

    assert found == [("results 1", ""), ("results 1", "It took too long."), ("results 2", "")]


def test_exclusions_outdate_figures_and_erasures_remove_them(
    opened: Database, clock: SetClock, figures: CountedFigures, ask: Ask
) -> None:
    ask()
    figures.work()
    decide_exclusion(opened, clock, 1, excluded=True, by="Ada", reason="came twice")
    clock.advance(seconds=REST + 1)
    assert not ask().is_current

    with opened.writing() as session:
        session.execute(delete(InterimFigures))
    # What was begun before that is not kept.
    assert figures.work() == 1
    assert ask().document == ""


@pytest.mark.slow
def test_the_process_returns_documents_or_a_reason(
    tiny_study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answer_study(tiny_study, people=3, stop_after=2)
    monkeypatch.chdir(tiny_study)
    # Files in the server's working directory must not be imported.
    (tiny_study / "analysis.py").write_text("raise SystemExit(5)", "utf-8")
    process = FigureProcess(tiny_study, sqlite_url(tiny_study / "responses.db"))

    agreement = figures_so_far(StudyFolder(tiny_study), "agreement")
    results = Document.model_validate_json(process.compute("results"))

    assert agreement.state == results.state == StudyState(finished=2, planned=4, answers=28)
    assert {row["question"] for row in agreement.rows} == {"rhythm", "emotion"}
    assert {row["measure"] for row in results.rows} == {"win_share"}
    (tiny_study / "study.toml").write_text("title = 1", "utf-8")
    with pytest.raises(SideProcessError, match=r"study\.toml"):
        process.compute("results")
    with pytest.raises(SideProcessError, match=r"longer than 0\.01 seconds"):
        process.compute("agreement", seconds=0.01)


@pytest.mark.parametrize("text", ["", '{"rows": []}', '{"state": null, "more": 1}'])
def test_values_kept_by_another_version_are_ignored(text: str) -> None:
    assert Document.read(text) is None
