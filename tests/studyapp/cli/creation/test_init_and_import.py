from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from studyapp.cli.main import group
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.settings.reading import read_study


def invoke(*arguments: object) -> Result:
    return CliRunner().invoke(group, [str(argument) for argument in arguments])


def test_init_makes_a_study_named_after_its_folder(tmp_path: Path) -> None:
    folder = tmp_path / "scott"
    result = invoke("init", folder, "--reference", "rule_based", "--trials", 6)
    assert result.exit_code == 0, result.output
    study = read_study(folder / "study.toml")
    assert isinstance(study, PairwiseStudy)
    assert (study.name, study.trials) == ("scott", 6)


def test_init_writes_a_study_in_a_language(tmp_path: Path) -> None:
    result = invoke("init", tmp_path / "s", "--template", "ranking", "--language", "de")

    assert result.exit_code == 0, result.output
    study = read_study(tmp_path / "s" / "study.toml")
    assert (study.page.language, study.title) == ("de", "Studie zu Bewegungen")


def test_init_never_overwrites_a_study(tmp_path: Path) -> None:
    assert invoke("init", tmp_path / "s").exit_code == 0
    again = invoke("init", tmp_path / "s")
    assert again.exit_code == 1
    assert "exists already" in again.output


@pytest.mark.parametrize(
    "flags",
    [
        ["--speech", "take.wav"],
        ["--segment", "10"],
        ["--emotion", "neutral"],
        ["--fps", "0"],
        ["--emotion", "boredom"],
    ],
)
def test_import_says_which_flags_belong_together(tmp_path: Path, flags: list[str]) -> None:
    invoke("init", tmp_path / "s")
    (tmp_path / "take.wav").touch()
    (tmp_path / "take.bvh").touch()
    flags = [str(tmp_path / "take.wav") if flag == "take.wav" else flag for flag in flags]
    result = invoke("import", tmp_path / "take.bvh", "--condition", "x", *flags, tmp_path / "s")
    assert result.exit_code == 2
    assert "Usage" in result.output or "--" in result.output


def test_import_of_a_broken_file_names_it(tmp_path: Path) -> None:
    invoke("init", tmp_path / "s")
    motion, speech = tmp_path / "take.bvh", tmp_path / "take.wav"
    motion.write_text("this is not a BVH")
    speech.write_bytes(b"nor is this sound")
    result = invoke(
        "import", motion, "--speech", speech, "--condition", "ground_truth",
        "--speaker", "anna", "--emotion", "neutral", tmp_path / "s",
    )  # fmt: skip
    assert result.exit_code == 1
    assert "take.wav" in result.output
    assert not (tmp_path / "s" / "speech").exists()


def test_import_says_that_it_moved_hands_unless_told_to_leave_them(
    tmp_path: Path, shared_data: Path
) -> None:
    motion, speech = (shared_data / f"2_scott_0_1_1.{ending}" for ending in ("bvh", "wav"))
    said = []
    for name, flags in (("moved", []), ("left", ["--as-recorded"])):
        invoke("init", tmp_path / name)
        result = invoke(
            "import", motion, "--speech", speech, "--fps", 15, "--condition", "recording",
            "--speaker", "scott", "--emotion", "neutral", *flags, tmp_path / name,
        )  # fmt: skip
        assert result.exit_code == 0, result.output
        said.append("hands were moved out" in result.output)
        copied = tmp_path / "2_scott_0_1_1.bvh"
        copied.write_bytes(motion.read_bytes())
        again = invoke(
            "import", copied, "--fps", 15, "--condition", "again", *flags, tmp_path / name
        )
        said.append("hands were moved out" in again.output)
    assert said == [True, True, False, False]
