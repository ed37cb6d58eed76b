from __future__ import annotations

import hashlib
import shutil
from pathlib import Path

import pytest

from tests.studyapp.cli.material.conftest import CORPUS, RATE
from tests.support.command_line import refused, run


def test_numbers_that_make_no_corpus_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    for options in (("--sentences", 12), ("--held-out-speakers", 8), ("--takes", 99)):
        refused("corpus", tmp_path / "corpus", *options)
        assert not (tmp_path / "corpus").exists()


def contents(folder: Path) -> dict[Path, str]:
    return {
        path.relative_to(folder): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.mark.slow
def test_one_process_or_two_make_the_same_takes_and_those_that_are_there_are_kept(
    corpus: Path, tmp_path: Path
) -> None:
    folder = Path(shutil.copytree(corpus, tmp_path / "corpus"))
    before = contents(folder)
    for speech in sorted(folder.glob("*/*.wav"))[:2]:
        for path in speech.parent.glob(f"{speech.stem}.*"):
            path.unlink()

    done = run("corpus", folder, *CORPUS, *RATE, "--processes", 2)
    assert "Made 2 takes" in done
    assert "14 were there" in done
    assert contents(folder) == before
    assert len(before) == 16 * 6 + 3
