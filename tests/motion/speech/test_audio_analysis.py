from __future__ import annotations

import fcntl
import os
import re
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from motion.speech.audio_analysis import load_librosa


def _load() -> None:
    from numba.core.caching import IndexDataCacheFile

    IndexDataCacheFile("/nowhere", "none", 0).load("none")


def _compile() -> None:
    import numba

    @numba.guvectorize(["void(float64[:], float64[:])"], "(n)->(n)", nopython=True)
    def double(x, y):
        y[:] = 2 * x


@pytest.fixture
def held(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Callable[[], None]]:
    """Hold the lock of a temporary folder of this test's own; give how to let it go."""
    load_librosa().util.localmax(np.zeros(4))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with (tmp_path / f"motionjury-{os.getuid()}-librosa.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield lambda: fcntl.flock(lock, fcntl.LOCK_UN)


def test_nobody_waits_for_what_another_process_computes(held: Callable[[], None]) -> None:
    load_librosa().util.localmax(np.zeros(9))


@pytest.mark.parametrize("work", [_load, _compile])
def test_compiled_functions_are_loaded_and_vectorised_ones_made_by_one_process_at_a_time(
    work: Callable[[], None], held: Callable[[], None]
) -> None:
    # The lock of an open file holds a thread that opens it again as it holds another process.
    with ThreadPoolExecutor(1) as other:
        done = other.submit(work)
        with pytest.raises(TimeoutError):
            done.result(timeout=0.5)
        held()
        done.result(timeout=60)


def test_nothing_else_in_the_project_imports_librosa() -> None:
    root = Path(__file__).resolve().parents[3]
    packages = ("motion", "generators", "renderer", "analysis", "studyapp", "training")
    importers = [
        path.name
        for package in packages
        for path in (root / package).rglob("*.py")
        if re.search(r"(import|from) librosa\b", path.read_text(encoding="utf-8"))
    ]
    assert importers == ["audio_analysis.py"]
