"""`motionjury check` for people and for programs."""

import re
from collections import Counter
from pathlib import Path

from studyapp.preflight.finding import CheckRecord
from tests.studyapp.conftest import OwnStudy
from tests.support.command_line import run


def record(folder: Path, *, status: int) -> CheckRecord:
    file = folder / "findings.json"
    run("check", folder, "--record", file, status=status)
    return CheckRecord.model_validate_json(file.read_bytes())


def test_warnings_alone_let_a_study_be_served_and_errors_end_with_status_one(
    own_study: OwnStudy,
) -> None:
    whole = own_study("rating").root
    assert re.search(
        r"can be served: 0 errors, \d warnings \(--verbose prints \d+ notes\)", run("check", whole)
    )
    assert "\nnote: " in run("check", whole, "--verbose")
    found = record(whole, status=0)
    assert (found.errors, found.study) == (0, whole.name)
    severities = Counter(finding.severity for finding in found.findings)
    assert severities == {"warning": found.warnings, "note": found.notes}

    next((whole / "videos" / "copies").glob("*.mp4")).unlink()

    output = run("check", whole, status=1)
    assert output.startswith("error: video-missing\n")
    assert "must be fixed before participants can take part (1 error, " in output
    found = record(whole, status=1)
    assert (found.errors, found.findings[0].name) == (1, "video-missing")


def test_every_invalid_key_of_a_study_file_is_a_finding(tiny_study: Path) -> None:
    definition = tiny_study / "study.toml"
    definition.write_text("colour = 3\nseed = -1\n" + definition.read_text())

    findings = record(tiny_study, status=1).findings

    assert [(f.name, f.where) for f in findings] == [("study-file", "study.toml")] * 2
    assert {f.what.split(":")[0] for f in findings} == {"colour", "seed"}
