"""`motionjury check` for people and for programs."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from studyapp.cli.main import group
from studyapp.preflight.finding import CheckRecord


def run(folder: Path, *arguments: str) -> Result:
    return CliRunner().invoke(group, ["check", str(folder), *arguments])


def found(folder: Path) -> CheckRecord:
    return CheckRecord.model_validate(json.loads(run(folder, "--json").output))


@pytest.fixture
def whole(finished_study: Callable[[str], Path], tmp_path: Path) -> Path:
    """Return a study in which nothing is wrong but what participants are not told."""
    return Path(shutil.copytree(finished_study("rating"), tmp_path / "study"))


def test_warnings_alone_let_a_study_be_served(whole: Path) -> None:
    said, as_json = run(whole), run(whole, "--json")

    assert (said.exit_code, as_json.exit_code) == (0, 0)
    assert "can be served" in said.output
    assert run(whole, "--json").output == as_json.output
    made = CheckRecord.model_validate_json(as_json.output)
    assert made.errors == 0 < made.warnings
    assert made.study == whole.name
    assert len(made.findings) == made.errors + made.warnings + made.notes


def test_errors_end_with_status_one_and_come_first(whole: Path) -> None:
    next((whole / "videos" / "copies").glob("*.mp4")).unlink()

    said, as_json = run(whole), run(whole, "--json")

    assert (said.exit_code, as_json.exit_code) == (1, 1)
    assert said.output.startswith("error: video-missing\n")
    assert "1 thing must be fixed" in said.output
    made = CheckRecord.model_validate_json(as_json.output)
    assert (made.errors, made.findings[0].name) == (1, "video-missing")


@pytest.mark.parametrize(
    ("codes", "names"),
    [
        ({"completed": "password", "screened_out": "KX7QM2PWTR"}, {"code-guessable"}),
        ({"completed": "KX7QM2PWTR", "screened_out": "KX7QM2PWTR"}, {"codes-alike"}),
    ],
)
def test_bad_codes_have_names_although_the_study_file_is_refused(
    tiny_study: Path, codes: dict[str, str], names: set[str]
) -> None:
    with (tiny_study / "study.toml").open("a") as file:
        file.write("\n[recruitment.prolific]\n")
        file.writelines(f'{key} = "{code}"\n' for key, code in codes.items())

    assert {each.name for each in found(tiny_study).findings} == names


def test_every_key_of_a_wrong_study_file_is_a_finding(tiny_study: Path) -> None:
    definition = tiny_study / "study.toml"
    definition.write_text(f"colour = 3\nseed = -1\n{definition.read_text()}")

    made = found(tiny_study)

    assert [(each.name, each.where) for each in made.findings] == [("study-file", "study.toml")] * 2
    assert {each.what.split(":")[0] for each in made.findings} == {"colour", "seed"}


def test_missing_speech_is_a_finding_beside_what_participants_are_not_told(
    tiny_study: Path,
) -> None:
    (tiny_study / "speech" / "segments.csv").unlink()

    made = found(tiny_study)

    assert (made.findings[0].name, made.findings[0].where) == (
        "speech-unreadable",
        "speech/segments.csv",
    )
    assert "ethics-missing" in {each.name for each in made.findings}
