"""`motionjury check` for people and for programs."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from studyapp.preflight.finding import CheckRecord, Finding
from tests.support.command_line import run


def check(folder: Path, *options: str, errors: bool = False) -> str:
    return run("check", folder, *options, status=int(errors))


@pytest.fixture
def whole(finished_study: Callable[[str], Path], tmp_path: Path) -> Path:
    """Return a study in which nothing is wrong but what participants are not told."""
    return Path(shutil.copytree(finished_study("rating"), tmp_path / "study"))


def test_warnings_alone_let_a_study_be_served(whole: Path) -> None:
    assert re.search(
        r"can be served: 0 errors, \d warnings \(--verbose tells \d+ notes\)", check(whole)
    )
    assert "\nnote: " in check(whole, "--verbose")

    as_json = check(whole, "--json")
    assert check(whole, "--json") == as_json
    made = CheckRecord.model_validate_json(as_json)
    assert made.errors == 0 < made.warnings
    assert made.study == whole.name
    assert len(made.findings) == made.errors + made.warnings + made.notes


def test_errors_end_with_status_one_and_come_first(whole: Path) -> None:
    next((whole / "videos" / "copies").glob("*.mp4")).unlink()

    said = check(whole, errors=True)

    assert said.startswith("error: video-missing\n")
    assert "1 thing must be fixed" in said
    made = CheckRecord.model_validate_json(check(whole, "--json", errors=True))
    assert (made.errors, made.findings[0].name) == (1, "video-missing")


def findings_of_file(folder: Path, *, before: str = "", behind: str = "") -> list[Finding]:
    """Return what is found where the study file has more lines."""
    definition = folder / "study.toml"
    definition.write_text(before + definition.read_text() + behind)
    return list(CheckRecord.model_validate_json(check(folder, "--json", errors=True)).findings)


def test_every_key_of_a_wrong_study_file_is_a_finding(tiny_study: Path) -> None:
    codes = '\n[recruitment.prolific]\ncompleted = "KX7QM2PWTR"\nscreened_out = "KX7QM2PWTR"\n'
    assert len(findings_of_file(tiny_study, behind=codes)) == 1
    found = findings_of_file(tiny_study, before="colour = 3\nseed = -1\n")

    assert [(each.name, each.where) for each in found] == [("study-file", "study.toml")] * 2
    assert {each.what.split(":")[0] for each in found} == {"colour", "seed"}
