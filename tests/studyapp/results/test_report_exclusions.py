"""A study's report leaves out whom its rules name, and tells planned rules from later ones."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from studyapp.results.report import report
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.exclusions import FailedCatch, StraightLining
from tests.finished_study import write_finished_study, write_short_video
from tests.studyapp.answered_study import answer_study

STRICTER = """
[[exclusions]]
rule = "incomplete"
[[exclusions]]
rule = "attention"
more_than = 0
"""


@pytest.fixture(scope="module")
def answered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a rating study that three participants answered by chance, the last one in part."""
    folder = tmp_path_factory.mktemp("rating")
    write_short_video(folder / "short.mp4")
    write_finished_study(folder, "rating", folder / "short.mp4")
    answer_study(folder, people=3, stop_after=2)
    return folder


def results(folder: Path, **options: Any) -> dict[str, Any]:
    page = report(StudyFolder(folder), **options)
    found: dict[str, Any] = json.loads(page.with_name("results.json").read_text("utf-8"))
    return found


def rules(found: dict[str, Any]) -> list[tuple[str, bool]]:
    return [(one["rule"], one["exploratory"]) for one in found["rules"]]


def test_the_rules_of_the_study_file_come_first_and_those_of_the_command_line_are_exploratory(
    answered: Path,
) -> None:
    found = results(
        answered, exclude=[StraightLining(at_least=1, trials=500), FailedCatch(more_than=0)]
    )
    assert rules(found) == [
        ("incomplete", False),
        ("attention", False),
        ("straight_lining", True),
        ("catch", True),
    ]
    assert found["exclusions"]["3"].endswith(" trials answered")
    assert [one["remark"] for one in found["rules"][2:]] == [
        "cannot be applied: no question has 500 answers that could be alike",
        "cannot be applied: there are no catch trials with a side known to be right",
    ]


def test_a_rule_that_changed_after_the_first_participant_is_exploratory(
    answered: Path, tmp_path: Path
) -> None:
    folder = shutil.copytree(answered, tmp_path / "study")
    with (folder / "study.toml").open("a", encoding="utf-8") as file:
        file.write(STRICTER)
    found = results(folder)
    assert rules(found) == [("incomplete", False), ("attention", True)]
    page = (folder / "report" / "report.html").read_text("utf-8")
    assert "Exclusion by attention&gt;0 was not in the study file when the first" in page
    assert "Exclusion by attention&gt;1 was in the study file when the first" in page
