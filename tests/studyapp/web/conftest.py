"""What the tests of pages share."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest


@pytest.fixture
def tiny_study(tiny_study: Path, empty_sqlite: Path) -> Path:
    """Return the study with an empty database of the newest schema: making one takes longer."""
    shutil.copyfile(empty_sqlite, tiny_study / "responses.db")
    return tiny_study
