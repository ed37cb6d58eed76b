"""A study from two recordings to its report, command by command, as a researcher types them."""

from __future__ import annotations

import contextlib
import csv
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from motion.audio import Audio, write_wav
from motion.clip import MotionClip
from motion.formats import write_clip
from studyapp.cli.main import group
from tests.edited_study import edited

pytestmark = pytest.mark.slow

RATE = 16_000
SECONDS = 6.0
PARTICIPANTS = 3


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("researcher")


@pytest.fixture(scope="module")
def motionjury(home: Path) -> Callable[..., str]:
    def run(*arguments: object) -> str:
        program = "from studyapp.cli.main import main; main()"
        done = subprocess.run(
            [sys.executable, "-c", program, *map(str, arguments)],
            cwd=home,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="module")
def within(home: Path) -> Callable[..., str]:
    """Return what runs a command in this process, where it need not show that it starts alone."""

    def run(*arguments: object) -> str:
        with contextlib.chdir(home):
            done = CliRunner().invoke(group, [*map(str, arguments)], catch_exceptions=False)
        assert done.exit_code == 0, done.output
        return done.output

    return run


@pytest.fixture(scope="module")
def study(home: Path, motionjury: Callable[..., str], within: Callable[..., str]) -> Path:
    """Return a study that went through every command up to its report."""
    times = np.arange(int(SECONDS * RATE)) / RATE
    loudness = np.maximum(np.sin(2 * np.pi * 1.7 * times), 0)
    samples = (0.4 * loudness * np.sin(2 * np.pi * 140 * times)).astype(np.float32)
    write_wav(home / "take.wav", Audio(samples=samples, sample_rate=RATE))
    frames = int(SECONDS * 30)
    poses = np.zeros((frames, 55, 3), np.float32)
    poses[:, 16, 2] = -1.1 + 0.3 * np.sin(2 * np.pi * 1.7 * np.arange(frames) / 30)
    poses[:, 17, 2] = 1.1
    take = MotionClip(poses=poses, trans=np.zeros((frames, 3), np.float32), frame_rate=30)
    write_clip(home / "take.npz", take)

    within("init", "lab", "--reference", "rule_based", "--trials", 3)
    definition = home / "lab" / "study.toml"
    with edited(definition) as document:
        document["video"].update({"size": 96, "frame_rate": 10})
        document["participants_per_comparison"] = PARTICIPANTS
    within(
        "import", "take.npz", "--speech", "take.wav", "--segment", 2,
        "--condition", "ground_truth", "--speaker", "anna", "--emotion", "anger", "lab",
    )  # fmt: skip
    within("generate", "lab")
    motionjury("render", "lab", "--processes", 1)
    motionjury("rehearse", "lab", "--seed", 1)
    motionjury("report", "lab")
    return home / "lab"


@pytest.fixture(scope="module")
def rehearsal_rows(study: Path, within: Callable[..., str]) -> list[dict[str, str]]:
    """Return what `export` writes of the rehearsal."""
    within("export", "lab", "--rehearsal")
    with (study / "rehearsal_responses.csv").open() as file:
        return list(csv.DictReader(file))


def test_check_finds_nothing_that_must_be_corrected(
    study: Path, within: Callable[..., str]
) -> None:
    said = within("check", "lab")
    assert "can be served" in said
    assert "3 segments of anger allow 3 pairs" in said
    assert "error:" not in said


def test_the_report_is_one_file_that_says_rehearsal_and_answers(study: Path) -> None:
    page = (study / "report" / "report.html").read_text()
    assert page.lower().count("rehearsal") > 5
    assert "win share" in page
    for outside in ('src="http', 'href="http', "@import", "url(http"):
        assert outside not in page


def test_rehearsal_answers_are_exported_apart_from_real_ones(
    study: Path, rehearsal_rows: list[dict[str, str]], within: Callable[..., str]
) -> None:
    rows = rehearsal_rows
    sessions = {row["study_session"] for row in rows}
    assert len(sessions) == 2 * PARTICIPANTS
    assert {row["comparison"] for row in rows} == {
        "rule_based-mismatched",
        "rule_based-ground_truth",
    }
    per_session = [sum(row["study_session"] == name for row in rows) for name in sessions]
    assert len(set(per_session)) == 1
    assert "Wrote 0 answers" in within("export", "lab")
    assert not (study / "responses.db").exists()


def test_catch_trials_show_the_ground_truth_beside_the_broken_motion(
    rehearsal_rows: list[dict[str, str]],
) -> None:
    catches = [row for row in rehearsal_rows if row["kind"] == "catch"]
    assert catches
    for row in catches:
        shown = {row["left_condition"], row["right_condition"]}
        assert shown == {"ground_truth", "broken"}


def test_every_stage_done_again_makes_nothing_new(study: Path, within: Callable[..., str]) -> None:
    assert "Generated 0 clips" in within("generate", "lab")
    assert "Rendered 0 videos" in within("render", "lab")
    assert f"{2 * PARTICIPANTS} of them in an earlier run" in within("rehearse", "lab")
