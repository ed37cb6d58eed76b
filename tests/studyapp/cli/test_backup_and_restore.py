from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from motion.errors import InputError
from studyapp.cli.backup_command import command as backup_command
from studyapp.cli.backup_command import restore_command
from tests.studyapp.answered_study import answer_study


@pytest.fixture
def study(
    finished_study: Callable[[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Path:
    monkeypatch.delenv("DATABASE_URL", raising=False)
    root = tmp_path / "study"
    shutil.copytree(finished_study("pairwise"), root)
    answer_study(root, people=1, stop_after=2)
    return root


def run(command: click.Command, *arguments: object) -> str:
    found = CliRunner().invoke(command, [*map(str, arguments)], catch_exceptions=False)
    assert found.exit_code == 0, found.output
    return found.output


def test_what_is_in_a_backup_and_who_is_back_is_said(study: Path, tmp_path: Path) -> None:
    archive = tmp_path / "out.tar.gz"
    said = run(backup_command, study, archive)
    assert "Backed up 1 participant with 2 answers" in said
    assert f"from sqlite:///{study / 'responses.db'}" in said
    assert "media files are not in it (--with-media)" in said
    assert "Keep it as safe as the answers" in said

    said = run(restore_command, archive, tmp_path / "new")
    assert "Restored 1 participant with 2 answers" in said
    assert "media files are missing" in said
    assert "Whoever was forgotten after" in said

    later = tmp_path / "later.tar.gz"
    run(backup_command, study, later)
    said = run(restore_command, archive, tmp_path / "again", "--forgotten-in", later)
    assert "Erased again: 0 forgotten" in said


def test_a_backup_is_checked_alone_and_beside_its_media(study: Path, tmp_path: Path) -> None:
    archive = tmp_path / "out.tar"
    run(backup_command, study, archive)

    assert "is whole: 1 participant" in run(backup_command, "--check", archive)
    assert "that it does not hold are in" in run(backup_command, study, "--check", archive)
    next((study / "videos").rglob("*.mp4")).unlink()
    with pytest.raises(InputError, match=r"1 are missing .*--with-media"):
        run(backup_command, study, "--check", archive)
    with pytest.raises(InputError, match="--check makes no backup"):
        run(backup_command, study, tmp_path / "x.tar", "--check", archive)
    archive.write_bytes(archive.read_bytes()[:-20_000])
    with pytest.raises(InputError, match="Take another backup"):
        run(backup_command, "--check", archive)


def test_a_folder_gets_one_backup_more_and_older_ones_go(study: Path, tmp_path: Path) -> None:
    (tmp_path / "backups").mkdir()
    assert "Wrote" in run(backup_command, study, tmp_path / "backups", "--keep", 1)
    older = next((tmp_path / "backups").iterdir())
    older.rename(older.with_name("study-20200101T000000Z.tar.gz"))

    said = run(backup_command, study, tmp_path / "backups", "--keep", 1)

    assert "Removed the older" in said
    assert len(list((tmp_path / "backups").iterdir())) == 1


def test_what_is_missing_on_the_command_line_is_said(study: Path) -> None:
    for arguments in ([], [str(study)]):
        found = CliRunner().invoke(backup_command, arguments)
        assert found.exit_code == 2
        assert "FOLDER OUT" in found.output
