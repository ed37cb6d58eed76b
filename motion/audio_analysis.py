"""Loading librosa safely in several processes at once, and detecting onsets with it.

Onsets are the audio beats that beat alignment compares a motion with. They come from spectral flux
and share nothing with the accents of `motion.prosody`, to which a rule-based generator ties its
gestures: a score must not measure a generator with its own ruler.
"""

import fcntl
import os
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, wraps
from pathlib import Path
from types import ModuleType
from typing import Any, Final

import numpy as np

from motion.arrays import Floats
from motion.audio import SPEECH_RATE, Audio

DETECTOR: Final = "librosa 0.11 spectral-flux onsets, 16 kHz, 10 ms hop"
"""Name of the detector in `speech_onsets`, for footnotes."""

_HOP: Final = 160
_SILENCE: Final = 1e-4


@cache
def load_librosa() -> ModuleType:
    """Import librosa on first use: it takes seconds, and few callers need it.

    librosa compiles functions on first use. numba caches them next to librosa's source, in files
    that it reads and writes without a lock. Two processes that do so at once can leave an index
    that names the wrong function, or a vectorised function whose halves come from two compilers
    (numba issue 10128); every later use ends in a segmentation fault (seen with librosa 0.11 and
    numba 0.68). A lock therefore lets one process at a time read or write these files or build a
    vectorised function. librosa's computations are not locked.
    """
    from numba.core.caching import IndexDataCacheFile
    from numba.np.ufunc.ufuncbuilder import UFuncDispatcher

    for owner, name in (
        (IndexDataCacheFile, "load"),
        (IndexDataCacheFile, "save"),
        (UFuncDispatcher, "compile"),
    ):
        setattr(owner, name, _one_call_at_a_time(getattr(owner, name)))
    import librosa

    return librosa


def _one_call_at_a_time(function: Callable[..., Any]) -> Callable[..., Any]:
    """Guard `function` with a lock that all processes of this user share."""
    from numba.core.compiler_lock import global_compiler_lock

    @wraps(function)
    def run(*args: Any, **kwargs: Any) -> Any:
        # The compiler's lock first, as when numba reads the files while it compiles: two threads
        # that took the locks in different orders would deadlock.
        with global_compiler_lock, _lock():
            return function(*args, **kwargs)

    return run


_thread_state = threading.local()
"""Whether this thread holds the lock."""


@contextmanager
def _lock() -> Iterator[None]:
    if getattr(_thread_state, "held", False):
        yield
        return
    path = Path(tempfile.gettempdir()) / f"motionjury-{os.getuid()}-librosa.lock"
    lock = os.open(path, os.O_CREAT | os.O_RDWR | os.O_NOFOLLOW, 0o600)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX)
        _thread_state.held = True
        yield
    finally:
        _thread_state.held = False
        os.close(lock)


def speech_onsets(audio: Audio) -> Floats:
    """Return the times at which sounds begin in `audio`.

    Parameters
    ----------
    audio : Audio
        Speech, mono.

    Returns
    -------
    ndarray, shape (N,)
        Onset times in seconds, ascending; empty for silence.

    Notes
    -----
    Onset strength is spectral flux over 128 mel bands (Böck & Widmer 2013), picked by librosa's
    own defaults, as in BEAT's evaluation (Liu et al. 2022) but at a finer hop.
    """
    samples = np.asarray(audio.samples, np.float32)
    if float(np.max(np.abs(samples), initial=0.0)) < _SILENCE:
        return np.zeros(0)
    librosa = load_librosa()
    if audio.sample_rate != SPEECH_RATE:
        samples = librosa.resample(samples, orig_sr=audio.sample_rate, target_sr=SPEECH_RATE)
    onsets = librosa.onset.onset_detect(y=samples, sr=SPEECH_RATE, hop_length=_HOP, units="time")
    return np.asarray(onsets, np.float64)
