import fcntl
import os
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion.audio import Audio
from motion.audio_analysis import load_librosa, speech_onsets


def _load() -> None:
    caching: Any = import_module("numba.core.caching")  # it carries no types
    caching.IndexDataCacheFile("/nowhere", "none", 0).load("none")


def _compile() -> None:
    numba: Any = import_module("numba")
    types = ["void(float64[:], float64[:])"]

    @numba.guvectorize(types, "(n)->(n)", nopython=True)  # type: ignore[untyped-decorator]  # numba has no types
    def double(x: np.ndarray, y: np.ndarray) -> None:
        y[:] = 2 * x


@pytest.fixture
def held(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Callable[[], None]]:
    """Hold the lock in this test's own temporary folder, and return its release."""
    load_librosa().util.localmax(np.zeros(4))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with (tmp_path / f"motionjury-{os.getuid()}-librosa.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield lambda: fcntl.flock(lock, fcntl.LOCK_UN)


@pytest.mark.parametrize("work", [_load, _compile])
def test_one_process_at_a_time_compiles_functions_and_plain_ones_do_not_wait(
    work: Callable[[], None], held: Callable[[], None]
) -> None:
    load_librosa().util.localmax(np.zeros(9))
    # A file lock blocks a thread that opens the file again, as it blocks another process.
    with ThreadPoolExecutor(1) as other:
        done = other.submit(work)
        with pytest.raises(TimeoutError):
            done.result(timeout=0.5)
        held()
        done.result(timeout=60)


def tones(sample_rate: int) -> Audio:
    """Return two seconds with a tone starting at .5, 1.0 and 1.5 s."""
    time = np.arange(2 * sample_rate) / sample_rate
    samples = np.zeros_like(time)
    for start in (0.5, 1.0, 1.5):
        on = (time >= start) & (time < start + 0.2)
        samples[on] = 0.5 * np.sin(2 * np.pi * 440 * time[on])
    return Audio(samples.astype(np.float32), sample_rate)


@pytest.mark.parametrize("sample_rate", [16000, 44100])
def test_onsets_are_where_sounds_begin_at_any_sampling_rate(sample_rate: int) -> None:
    onsets = speech_onsets(tones(sample_rate))
    nearest = np.abs(np.subtract.outer([0.5, 1.0, 1.5], onsets)).min(axis=1)
    assert nearest.max() < 0.04


def test_silence_has_no_onset() -> None:
    assert speech_onsets(Audio(np.zeros(16000, np.float32), 16000)).shape == (0,)
