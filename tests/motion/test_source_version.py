from __future__ import annotations

from pathlib import Path

import pytest

from motion import source_version as module
from motion.source_version import source_version


@pytest.fixture
def sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(module, "_ROOT", tmp_path)
    (tmp_path / "a.py").write_text("1")
    (tmp_path / "b.py").write_text("2")
    return tmp_path


def test_the_version_follows_every_matching_file_and_no_other(sources: Path) -> None:
    before = source_version(["*.py"])
    (sources / "c.txt").write_text("3")
    assert source_version(["*.py"]) == before
    (sources / "a.py").write_text("changed")
    assert source_version(["*.py"]) != before


def test_renaming_or_exchanging_files_changes_the_version(sources: Path) -> None:
    before = source_version(["*.py"])
    (sources / "a.py").write_text("2")
    (sources / "b.py").write_text("1")
    assert source_version(["*.py"]) != before


def test_package_versions_count(sources: Path) -> None:
    assert source_version(["*.py"], ["numpy"]) != source_version(["*.py"])
