from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support.command_line import run
from tests.support.studies.answered_study import answer_study


@pytest.fixture
def study(
    finished_study: Callable[[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Path:
    monkeypatch.delenv("DATABASE_URL", raising=False)
    root = Path(shutil.copytree(finished_study("pairwise"), tmp_path / "study"))
    answer_study(root, people=1, stop_after=2)
    return root


def test_what_is_in_a_backup_and_who_is_back_is_said(study: Path, tmp_path: Path) -> None:
    archive = tmp_path / "out.tar.gz"
    said = run("backup", study, archive)
    assert "Backed up 1 participant with 2 answers" in said
    assert f"from sqlite:///{study / 'responses.db'}" in said
    assert "media files are not in it (--with-media)" in said
    assert "Keep it as safe as the answers" in said

    said = run("restore", archive, tmp_path / "new")
    assert "Restored 1 participant with 2 answers" in said
    assert "media files are missing" in said
    assert "Whoever was forgotten after" in said


def test_a_backup_is_checked_alone_and_beside_its_media(study: Path, tmp_path: Path) -> None:
    archive = tmp_path / "out.tar"
    run("backup", study, archive)

    assert "is whole: 1 participant" in run("backup", "--check", archive)
    assert "that it does not hold are in" in run("backup", study, "--check", archive)
    next((study / "videos").rglob("*.mp4")).unlink()
    assert "1 are missing" in run("backup", study, "--check", archive, status=1)
    both = run("backup", study, tmp_path / "x.tar", "--check", archive, status=1)
    assert "--check makes no backup" in both
    archive.write_bytes(archive.read_bytes()[:-20_000])
    assert "Take another backup" in run("backup", "--check", archive, status=1)
