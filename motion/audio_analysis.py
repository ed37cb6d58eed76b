"""librosa, used by one process at a time."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType


@contextmanager
def librosa_alone() -> Iterator[ModuleType]:
    """Give librosa while no other process of this user has it.

    librosa compiles itself when it is first used and keeps the result beside its source. Two
    processes that do so at the same time leave a damaged file there, and every later use ends
    in a segmentation fault (seen with librosa 0.11 and numba 0.68).

    It is imported here and not before, because that takes seconds and few callers need it. A
    block must not be entered within another one.
    """
    path = Path(tempfile.gettempdir()) / f"motionjury-{os.getuid()}-librosa.lock"
    lock = os.open(path, os.O_CREAT | os.O_RDWR | os.O_NOFOLLOW, 0o600)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX)
        import librosa

        yield librosa
    finally:
        os.close(lock)
