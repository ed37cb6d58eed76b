from __future__ import annotations

import fcntl
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from motion.audio_analysis import load_librosa

_LOAD = """
from motion.audio_analysis import load_librosa
librosa = load_librosa()
from numba.core.caching import IndexDataCacheFile
files = IndexDataCacheFile("/nowhere", "none", 0)
files.load("none")
print("loaded", flush=True)
"""

_COMPILE = """
from motion.audio_analysis import load_librosa
load_librosa()
import numba

@numba.guvectorize(["void(float64[:], float64[:])"], "(n)->(n)", nopython=True)
def double(x, y):
    y[:] = 2 * x

print("compiled", flush=True)
"""


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


def test_compiled_functions_are_loaded_by_one_process_at_a_time(held: Callable[[], None]) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", _LOAD], stdout=subprocess.PIPE, text=True
    ) as other:
        with pytest.raises(subprocess.TimeoutExpired):
            other.communicate(timeout=3)
        held()
        assert other.communicate(timeout=60)[0] == "loaded\n"


def test_a_vectorised_function_is_made_by_one_process_at_a_time(held: Callable[[], None]) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", _COMPILE], stdout=subprocess.PIPE, text=True
    ) as other:
        with pytest.raises(subprocess.TimeoutExpired):
            other.communicate(timeout=5)
        held()
        assert other.communicate(timeout=60)[0] == "compiled\n"


def test_nothing_else_in_the_project_imports_librosa() -> None:
    root = Path(__file__).resolve().parents[2]
    packages = ("motion", "generators", "renderer", "analysis", "studyapp", "training")
    importers = [
        path.name
        for package in packages
        for path in (root / package).rglob("*.py")
        if re.search(r"(import|from) librosa\b", path.read_text(encoding="utf-8"))
    ]
    assert importers == ["audio_analysis.py"]
