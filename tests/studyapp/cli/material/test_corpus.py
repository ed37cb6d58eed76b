from __future__ import annotations

import hashlib
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from studyapp.cli.main import group


def run(*arguments: object) -> Result:
    return CliRunner().invoke(group, ["--debug", "corpus", *map(str, arguments)])


def test_numbers_that_make_no_corpus_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    for options in (("--sentences", 12), ("--held-out-speakers", 8), ("--takes", 99)):
        done = run(tmp_path / "corpus", *options)
        assert done.exit_code != 0
        assert not (tmp_path / "corpus").exists()


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("espeak-ng") is None, reason="espeak-ng is not installed")
def test_one_process_or_two_make_the_same_corpus_and_what_is_there_is_kept(tmp_path: Path) -> None:
    options = ("--speakers", 1, "--sentences", 8, "--takes", 1, "--held-out-speakers", 0)
    contents = []
    for processes in (1, 2):
        folder = tmp_path / str(processes)
        done = run(folder, *options, "--fps", 10, "--processes", processes)
        assert done.exit_code == 0, done.output
        assert "Made 8 takes" in done.stdout
        files = sorted(path for path in folder.rglob("*") if path.is_file())
        contents.append(
            [
                (path.relative_to(folder), hashlib.sha256(path.read_bytes()).hexdigest())
                for path in files
            ]
        )
    assert contents[0] == contents[1]
    assert len(contents[0]) == 8 * 6 + 3
    again = run(folder, *options, "--fps", 10)
    assert "Made 0 takes" in again.stdout
    assert "8 were there" in again.stdout
