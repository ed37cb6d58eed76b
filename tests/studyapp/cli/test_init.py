"""New studies from options."""

from pathlib import Path
from typing import get_args

import pytest

from generators.learned_settings import ModelSettings
from studyapp.preflight.check import check
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.reading import read_study
from studyapp.study.settings.recruitment import Channel
from tests.support.command_line import run


@pytest.mark.parametrize("template", ["pairwise", "rating", "ranking", "mismatch", "three-systems"])
def test_a_new_study_lacks_only_media(tmp_path: Path, template: str) -> None:
    for channel in get_args(Channel):
        run(
            "init", tmp_path / channel, "--template", template, "--condition", "real=files",
            "--condition", "ours=files", "--condition", "late=mismatched:ours", "--recruit",
            channel, "--pay", "3 USD", "--minutes", 20,
        )  # fmt: skip

    channel = get_args(Channel)[len(template) % 4]
    findings = check(StudyFolder(tmp_path / channel))
    errors = [finding.name for finding in findings if finding.severity == "error"]
    assert errors == ["speech-unreadable"]


def test_options_end_up_in_the_study_file(tmp_path: Path) -> None:
    weights = tmp_path / "elsewhere" / "ours.safetensors"
    weights.parent.mkdir()
    weights.touch()
    run(
        "init", tmp_path / "s", "--template", "rating", "--condition", "real=files",
        "--condition", f"ours=diffsheg:{weights}", "--condition", "late=mismatched:ours",
        "--participants", 40, "--recruit", "prolific", "--pay", "3 GBP", "--minutes", 20,
        "--organisation", "Lab", "--contact", "lab@example.org", "--ethics", "No. 7",
        "--language", "ja",
    )  # fmt: skip

    study = read_study(tmp_path / "s" / "study.toml")
    assert study.arms[0].places == 40
    assert list(study.conditions) == ["real", "ours", "late"]
    assert isinstance(study.conditions["ours"].settings, ModelSettings)
    assert study.conditions["ours"].settings.checkpoint == weights
    assert (study.recruitment.prolific.reward, study.recruitment.missing_codes) == (300, [])
    assert (study.page.ethics, study.page.language) == ("No. 7", "ja")


def test_finished_videos_have_catch_trials_if_flawed_videos_are_planned(tmp_path: Path) -> None:
    videos = ("--condition", "real=videos", "--condition", "ours=videos")

    output = run("init", tmp_path / "with", *videos, "--catch-videos")
    run("init", tmp_path / "without", *videos)
    mixed = run("init", tmp_path / "mixed", *videos[:2], "--condition", "theirs=files")

    assert "Next: put your videos into videos/CONDITION/SEGMENT.mp4" in output
    assert "Next: import speech with 'motionjury import', put your videos into" in mixed
    flawed, none = (read_study(tmp_path / name / "study.toml") for name in ("with", "without"))
    assert (flawed.catch.videos, flawed.catch.trials) == (True, 3)
    assert (none.catch.trials, none.attention.trials) == (0, 2)
