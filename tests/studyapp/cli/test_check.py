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
    """Return a study without errors."""
    return Path(shutil.copytree(finished_study("rating"), tmp_path / "study"))


def test_warnings_alone_let_a_study_be_served(whole: Path) -> None:
    assert re.search(
        r"can be served: 0 errors, \d warnings \(--verbose prints \d+ notes\)", check(whole)
    )
    assert "\nnote: " in check(whole, "--verbose")

    as_json = check(whole, "--json")
    assert check(whole, "--json") == as_json
    record = CheckRecord.model_validate_json(as_json)
    assert record.errors == 0 < record.warnings
    assert record.study == whole.name
    assert len(record.findings) == record.errors + record.warnings + record.notes


def test_errors_end_with_status_one_and_come_first(whole: Path) -> None:
    next((whole / "videos" / "copies").glob("*.mp4")).unlink()

    output = check(whole, errors=True)

    assert output.startswith("error: video-missing\n")
    assert "must be fixed before participants can take part (1 error, " in output
    record = CheckRecord.model_validate_json(check(whole, "--json", errors=True))
    assert (record.errors, record.findings[0].name) == (1, "video-missing")


def findings_of_file(folder: Path, *, before: str = "", behind: str = "") -> list[Finding]:
    """Return the findings once lines are added to the study file."""
    definition = folder / "study.toml"
    definition.write_text(before + definition.read_text() + behind)
    return list(CheckRecord.model_validate_json(check(folder, "--json", errors=True)).findings)


def test_every_key_of_a_wrong_study_file_is_a_finding(tiny_study: Path) -> None:
    codes = '\n[recruitment.prolific]\ncompleted = "KX7QM2PWTR"\nscreened_out = "KX7QM2PWTR"\n'
    assert len(findings_of_file(tiny_study, behind=codes)) == 1
    findings = findings_of_file(tiny_study, before="colour = 3\nseed = -1\n")

    assert [(f.name, f.where) for f in findings] == [("study-file", "study.toml")] * 2
    assert {f.what.split(":")[0] for f in findings} == {"colour", "seed"}
