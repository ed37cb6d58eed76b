from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner, Result

from motion.clip import MotionClip
from motion.formats import write_clip
from studyapp.cli.main import group
from tests.analysis.evaluators.published_weights import write_checkpoint


def run(*arguments: object) -> Result:
    return CliRunner().invoke(group, ["metrics", *map(str, arguments), "--processes", "1"])


@pytest.fixture
def generated(tmp_path: Path) -> Path:
    """Return a folder of one waving and one damaged clip."""
    poses = np.zeros((40, 55, 3), np.float32)
    poses[:, 16, 2] = np.sin(np.arange(40) / 5)
    clip = MotionClip(poses=poses, trans=np.zeros((40, 3), np.float32), frame_rate=30)
    write_clip(tmp_path / "ours" / "a.npz", clip)
    (tmp_path / "ours" / "b.npz").write_bytes(b"cut")
    return tmp_path / "ours"


def test_scores_are_shown_and_written_and_damaged_files_are_counted(
    generated: Path, tmp_path: Path
) -> None:
    out = tmp_path / "scores.csv"
    shown = run("--generated", generated, "--preset", "genea", "--out", out)
    assert shown.exit_code == 0, shown.output
    assert "jerk (genea), m/s³" in shown.stdout
    assert "near the reference" in shown.stdout
    assert f"skipped: {generated / 'b.npz'}" in shown.stderr
    assert "1 file skipped." in shown.stderr
    assert pd.read_csv(out)["segment"].dropna().unique().tolist() == ["a"]


def test_a_missing_score_is_a_dash_with_its_reason(generated: Path) -> None:
    shown = run("--generated", generated, "--preset", "diffsheg")
    row = next(line for line in shown.stdout.splitlines() if line.startswith("mean distance"))
    assert "–" in row
    assert "a distance needs two clips" in shown.stderr


def test_a_published_evaluator_is_named_by_its_preset_and_printed_twice(
    generated: Path, tmp_path: Path
) -> None:
    poses = np.zeros((90, 55, 3), np.float32)
    for folder, swing in (("theirs", 0.5), ("ours", 1.0)):
        poses[:, 16, 2] = swing * np.sin(np.arange(90) / 5)
        clip = MotionClip(poses=poses, trans=np.zeros((90, 3), np.float32), frame_rate=30)
        write_clip(tmp_path / folder / "c.npz", clip)
    file = write_checkpoint(tmp_path, "talkshow")
    given = ("--generated", generated, "--reference", tmp_path / "theirs", "--preset", "genea")
    shown = run(*given, "--evaluator", f"talkshow={file}")
    assert "FGD (TalkSHOW's evaluator)" in shown.stdout
    assert "FGD by the published rule (TalkSHOW's evaluator)" in shown.stdout
    assert "do not fill 64 dimensions" in shown.stderr
    missing = run(*given, "--evaluator", "emage=none.bin")
    assert missing.exit_code == 1 and "no such file" in missing.stderr


def test_positions_are_kept_where_the_cache_is(generated: Path, tmp_path: Path) -> None:
    run("--generated", generated, "--preset", "genea", "--cache", tmp_path / "kept")
    assert len(list((tmp_path / "kept").iterdir())) == 1


def test_nothing_that_can_be_measured_is_a_failure(tmp_path: Path) -> None:
    (tmp_path / "b.npz").write_bytes(b"cut")
    shown = run("--generated", tmp_path)
    assert shown.exit_code == 1
    assert "b.npz" in shown.stderr
    assert "no motion file could be measured" in shown.stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((), "of a study or of folders, not of both or neither"),
        (("--generated", "ours", "--out", "scores.xlsx"), ".csv, .json, .parquet"),
        (("--generated", "ours", "--preset", "best"), "'best' is not one of"),
    ],
)
def test_what_does_not_fit_together_is_refused(
    generated: Path, arguments: tuple[str, ...], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(generated.parent)
    shown = run(*arguments)
    assert shown.exit_code != 0
    assert said in shown.stderr
    assert "Traceback" not in shown.output
