from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.support.command_line import run
from tests.support.studies.takes import write_motion


@pytest.fixture
def generated(tmp_path: Path) -> Path:
    """Return a folder of one moving and one damaged clip."""
    write_motion(tmp_path / "ours" / "a.npz", 1.5)
    (tmp_path / "ours" / "b.npz").write_bytes(b"cut")
    return tmp_path / "ours"


def test_scores_are_shown_and_written_and_damaged_files_are_counted(
    generated: Path, tmp_path: Path
) -> None:
    out = tmp_path / "scores.csv"
    given = ("--generated", generated, "--processes", 1)
    shown = run("metrics", *given, "--preset", "genea", "--out", out)
    assert "jerk (genea), m/s³" in shown
    assert "near the reference" in shown
    assert f"skipped: {generated / 'b.npz'}" in shown
    assert "1 file skipped." in shown
    assert pd.read_csv(out)["segment"].dropna().unique().tolist() == ["a"]


def test_a_note_is_printed_once_with_the_number_of_files(tmp_path: Path) -> None:
    trans = np.zeros((40, 3), np.float32)
    trans[:, 0] = np.arange(40)
    (tmp_path / "ours").mkdir()
    for name in "abc":
        poses = np.zeros((40, 165), np.float32)
        file = tmp_path / "ours" / f"{name}.npz"
        np.savez(file, poses=poses, trans=trans, mocap_framerate=30, betas=np.zeros(10))
    shown = run("metrics", "--generated", tmp_path / "ours", "--processes", 1, "--preset", "genea")
    assert shown.count("note: ") == 1
    assert "no finger is in the file" in shown
    assert "(and 2 other files)" in shown


def test_a_missing_score_is_a_dash_and_no_scores_at_all_a_failure(generated: Path) -> None:
    (generated / "a.json").write_text("{")
    given = ("--generated", generated, "--processes", 1)
    shown = run("metrics", *given, "--preset", "diffsheg", status=1)
    row = next(line for line in shown.splitlines() if line.startswith("mean distance"))
    assert "–" in row
    assert "a distance needs two clips" in shown
    assert "note: ours: a.json, next to a.npz, is left out" in shown
    assert "no motion file could be measured" in shown
