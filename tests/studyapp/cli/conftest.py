"""A small synthetic corpus, made once for tests that train on it or make it again."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from studyapp.cli.main import group

CORPUS = ("--speakers", "2", "--sentences", "8", "--takes", "1", "--held-out-speakers", "0")
RATE = ("--fps", "15")


@pytest.fixture(scope="session")
def corpus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return sixteen takes by two speakers, which one process made; nobody changes them."""
    if shutil.which("espeak-ng") is None:
        pytest.skip("espeak-ng is not installed")
    folder = tmp_path_factory.mktemp("corpus") / "corpus"
    done = CliRunner().invoke(group, ["corpus", str(folder), *CORPUS, *RATE, "--processes", "1"])
    assert done.exit_code == 0, done.output
    assert "Made 16 takes" in done.stdout
    return folder
