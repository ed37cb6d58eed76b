from __future__ import annotations

import os
from pathlib import Path, PurePosixPath

import pytest

from motion.errors import InputError
from studyapp.custody.deployment import planned_deployment
from studyapp.custody.server_files import write_deployment

STUDY = planned_deployment(
    title="Gestures", folder=PurePosixPath("/srv/motionjury/my-study"), host="study.example.org"
)


def test_files_have_their_modes_whatever_the_umask_is(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        files = write_deployment(STUDY, tmp_path / "new" / "out")
    finally:
        os.umask(before)

    modes = {path.name: path.stat().st_mode & 0o777 for path in (tmp_path / "new/out").iterdir()}
    assert modes == {file.name: file.mode for file in files}
    assert (modes["environment"], modes["install"], modes["Caddyfile"]) == (0o600, 0o755, 0o644)


def test_what_is_there_already_is_never_overwritten(tmp_path: Path) -> None:
    (tmp_path / "environment").write_text("PROLIFIC_TOKEN=secret\n", "utf-8")

    with pytest.raises(InputError, match="something already"):
        write_deployment(STUDY, tmp_path)

    assert [path.name for path in tmp_path.iterdir()] == ["environment"]


def test_two_runs_write_the_same(tmp_path: Path) -> None:
    for out in ("one", "two"):
        write_deployment(STUDY, tmp_path / out)

    one, two = (
        {path.name: path.read_bytes() for path in (tmp_path / out).iterdir()}
        for out in ("one", "two")
    )
    assert one == two
