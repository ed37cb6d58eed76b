from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from renderer.pair import FrameCache


def write(folder: Path, name: str, size: int, used: int) -> Path:
    folder.mkdir(exist_ok=True)
    path = folder / f"{name}.mkv"
    path.write_bytes(bytes(size))
    os.utime(path, (used, used))
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "frames"


def test_using_frames_makes_them_recent(folder: Path) -> None:
    old, new = write(folder, "a", 10, 1), write(folder, "b", 10, 2)
    cache = FrameCache(folder, 10)
    cache.mark_used(old)
    cache.shrink(required=())
    assert (old.exists(), new.exists()) == (True, False)


def test_orphaned_frames_are_removed_but_not_unfinished_ones(folder: Path) -> None:
    FrameCache(folder, 0).keep_only(())
    mine, stale, draft = (write(folder, name, 1, 1) for name in ("mine", "stale", ".draft"))
    FrameCache(folder, 100).keep_only({mine})
    assert (mine.exists(), stale.exists(), draft.exists()) == (True, False, True)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    sizes=st.lists(st.integers(0, 50), max_size=8),
    limit=st.integers(0, 200),
    needed=st.sets(st.integers(0, 7)),
)
def test_the_limit_spares_required_frames_and_removes_no_more_than_needed(
    tmp_path: Path, sizes: list[int], limit: int, needed: set[int]
) -> None:
    folder = tmp_path / "many"
    for old in folder.glob("*"):
        old.unlink()
    files = [write(folder, str(n), size, used=n + 1) for n, size in enumerate(sizes)]
    required = {files[n] for n in needed if n < len(files)}
    cache = FrameCache(folder, limit)
    cache.shrink(required=required)
    left = {path for path in files if path.exists()}
    assert required <= left
    assert cache.size() <= max(limit, sum(sizes[files.index(path)] for path in required))
    gone = [path for path in files if path not in left]
    if gone:
        assert cache.size() + sizes[files.index(gone[-1])] > limit
