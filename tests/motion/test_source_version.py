from __future__ import annotations

from pathlib import Path

import pytest

from motion import source_version as module
from motion.source_version import imported_sources, source_version


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


def test_imports_are_followed_through_functions_and_packages_but_not_to_parents(
    sources: Path,
) -> None:
    (sources / "room").mkdir()
    (sources / "room" / "__init__.py").write_text("import b")
    (sources / "room" / "door.py").write_text("import os\ndef open():\n    from room import key")
    (sources / "room" / "key.py").write_text("from room.metal import Iron")
    (sources / "room" / "metal.py").write_text("import a")
    (sources / "room" / "window.py").write_text("import room.door")

    assert imported_sources(["room.metal"]) == ("a.py", "room/metal.py")
    assert imported_sources(["room.door"]) == (
        "a.py", "b.py", "room/__init__.py", "room/door.py", "room/key.py", "room/metal.py",
    )  # fmt: skip


def test_modules_that_import_each_other_are_found_once(sources: Path) -> None:
    (sources / "a.py").write_text("import b")
    (sources / "b.py").write_text("import a")
    assert imported_sources(["a", "numpy"]) == ("a.py", "b.py")
