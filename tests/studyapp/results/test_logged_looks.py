"""Reports list earlier looks at results, and are looks themselves."""

import gzip
import json
import shutil
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import update

from analysis.stats.multiple_testing import NOT_LOGGED, LooksBefore, false_positive_rate
from studyapp.database.tables.study_session import IntakeChange, StudySession
from studyapp.researchers.audit import StudyState, latest_looks, log_look
from studyapp.results.answers import read_answers
from studyapp.results.export.sharing import share
from studyapp.results.export.tables import export
from studyapp.results.looks import earlier_looks, record_look
from studyapp.results.report import report
from studyapp.study.folder import StudyFolder
from tests.studyapp.results.conftest import Answered
from tests.support.studies.stored import opened, writing

NOON = datetime(2026, 5, 4, 12, tzinfo=UTC)


@pytest.fixture
def folder(answered: Answered) -> StudyFolder:
    return answered("rating", people=3, stop_after=1)


def stored_looks(folder: StudyFolder) -> list[tuple[str, str, str, int]]:
    with opened(folder.responses) as database:
        return [
            (one.way, one.researcher, one.reason, one.finished) for one in latest_looks(database)
        ]


def looked(folder: StudyFolder, *, by: str, finished: int, reason: str, times: int = 1) -> None:
    """Log earlier looks on a page."""
    with writing(folder.responses) as session:
        for _ in range(times):
            state = StudyState(finished=finished, planned=25, answers=10 * finished)
            log_look(session, NOON, state, way="page", by=by, reason=reason)


FINISHED = {"completed_at": NOON, "completion_code": "CODE-OF-THE-LAST"}


def change_last(folder: StudyFolder, **values: object) -> None:
    """Change what is stored of the one who has not finished."""
    with writing(folder.responses) as session:
        last = update(StudySession).where(StudySession.completed_at.is_(None))
        session.execute(last.values(values))


def noted(folder: StudyFolder, reason: str = "") -> str:
    return record_look(
        folder, folder.study(), read_answers(folder, "participants"), way="report", reason=reason
    )


def before(folder: StudyFolder) -> LooksBefore:
    return earlier_looks(folder.study(), read_answers(folder, "participants"))


def test_reports_list_earlier_looks_also_in_another_lab(
    folder: StudyFolder, tmp_path: Path
) -> None:
    looked(folder, by="Ada Lovelace", finished=1, reason="=videos <stalled>", times=3)
    looked(folder, by="Charles", finished=0, reason="curious")
    share(folder, tmp_path / "out")
    there = StudyFolder(tmp_path / "out" / "sourcedata" / "study")
    said: list[str] = []

    page = report(folder, reason="a video broke", warn=said.append)

    assert before(there) == before(folder)
    assert noted(there) == ""
    found = json.loads(page.with_name("results.json").read_bytes())["looks"]
    assert (found["count"], found["finished"]) == (4, [0, 1])
    assert found["false_positive_rate"] == pytest.approx(false_positive_rate(range(1, 3)))
    assert [(one["day"], one["by"], one["reason"], one["times"]) for one in found["looks"]] == [
        ("2026-05-04", "researcher 1", "=videos <stalled>", 3),
        ("2026-05-04", "researcher 2", "curious", 1),
    ]
    text = page.read_text("utf-8")
    assert "Looks at results before the end" in text and "videos &lt;stalled&gt;" in text
    assert text.count("Results were looked at 4 times before these answers were complete") >= 2
    passed_on = gzip.decompress(there.shared_answers.read_bytes()).decode()
    assert "Lovelace" not in text + passed_on and "Charles" not in text + passed_on
    assert (page.parent / "tables" / "looks.csv").exists()
    assert len(said) == 1 and said[0].startswith("2 of 3 planned participants have finished")
    assert stored_looks(folder)[0] == ("report", "", "a video broke", 2)


def test_a_report_counts_as_a_look_only_for_later_answers(folder: StudyFolder) -> None:
    said = noted(folder, "a video broke"), noted(folder)

    assert stored_looks(folder) == [("report", "", "", 2), ("report", "", "a video broke", 2)]
    assert "This look is logged" in said[0] and said[0] == said[1]
    assert (before(folder).count, before(folder).reason) == (0, "no look is logged")
    with writing(folder.responses) as session:
        session.add(
            IntakeChange(at=NOON, state="closed", more_places=0, reason="enough", researcher="")
        )
    change_last(folder, last_active_at=datetime.now(UTC))
    assert noted(folder) == said[0]
    change_last(folder, last_active_at=datetime.now(UTC) - timedelta(days=1))
    assert noted(folder) == ""

    change_last(folder, **FINISHED)
    assert noted(folder) == ""
    assert len(stored_looks(folder)) == 5
    first, _ = before(folder).looks
    assert (first.by, first.finished, first.planned) == ("command line", 2, 3)
    assert before(folder).false_positive_rate == pytest.approx(false_positive_rate([2, 3]))


def test_without_answers_nothing_counts_as_a_look_and_an_unloggable_look_is_reported(
    folder: StudyFolder, finished_study: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError("the disk is full")

    monkeypatch.setattr("studyapp.results.looks.log_look", refuse)
    unanswered = StudyFolder(finished_study("rating"))

    assert (noted(unanswered), before(unanswered)) == ("", NOT_LOGGED)
    assert not unanswered.responses.exists()
    assert "This look could not be logged: the disk is full" in noted(folder)


def test_an_export_is_a_look_that_later_reports_list(folder: StudyFolder, tmp_path: Path) -> None:
    tables = export(folder, tmp_path / "answers.csv", reason="for the talk")
    other_lab = share(folder, tmp_path / "first")
    share(folder, tmp_path / "second")
    export(folder, tmp_path / "withdrawn.csv", withdrawn=True)
    shutil.copyfile(folder.responses, folder.rehearsal)
    export(folder, tmp_path / "rehearsed.csv", rehearsal=True)

    unsaid = ("export", "", "", 2)
    assert stored_looks(folder) == [unsaid, unsaid, ("export", "", "for the talk", 2)]
    assert tables.look.startswith("2 of 3 planned participants have finished")
    assert (
        "because of the answers makes false findings" in tables.look
        and other_lab.remarks[-1] == tables.look
    )
    passed_on = StudyFolder(tmp_path / "second" / "sourcedata" / "study")
    shared = read_answers(passed_on, "participants").stored
    assert shared is not None and shared.looks.empty
    change_last(folder, **FINISHED)
    assert [(one.way, one.by, one.reason, one.times) for one in before(folder).looks] == [
        ("export", "command line", "for the talk", 1),
        ("export", "command line", "", 2),
    ]
