"""The process that computes figures: what it hands over, and how it fails."""

from __future__ import annotations

from pathlib import Path

import pytest

from studyapp.database.engine import Database, sqlite_url
from studyapp.researchers.interim.computing import FigureProcess, NoFiguresError
from studyapp.researchers.interim.documents import Document
from studyapp.results.so_far import agreement_so_far
from studyapp.study.folder import StudyFolder
from tests.studyapp.answered_study import answer_study


@pytest.mark.slow
def test_the_process_hands_over_documents_and_says_why_it_cannot(
    tiny_study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answer_study(tiny_study, people=3, stop_after=2)
    monkeypatch.chdir(tiny_study)
    # What lies where the server was started is not to be taken for a package.
    (tiny_study / "analysis.py").write_text("raise SystemExit(5)", "utf-8")
    process = FigureProcess(tiny_study, sqlite_url(tiny_study / "responses.db"))

    agreement = agreement_so_far(StudyFolder(tiny_study))
    results = Document.model_validate_json(process.compute("results"))

    assert agreement.basis == results.basis
    assert (results.basis.finished, results.basis.planned, results.basis.answers) == (2, 4, 28)
    assert {row["question"] for row in agreement.rows} == {"rhythm", "emotion"}
    assert {row["measure"] for row in results.rows} == {"win_share"}
    (tiny_study / "study.toml").write_text("title = 1", "utf-8")
    with pytest.raises(NoFiguresError, match=r"study\.toml"):
        process.compute("results")


def test_a_process_that_takes_too_long_is_stopped(tiny_study: Path) -> None:
    Database.open(sqlite_url(tiny_study / "responses.db")).close()
    process = FigureProcess(tiny_study, sqlite_url(tiny_study / "responses.db"))

    with pytest.raises(NoFiguresError, match=r"longer than 0\.01 seconds"):
        process.compute("agreement", seconds=0.01)
