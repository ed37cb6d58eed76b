"""librosa, whose compiled functions several processes may load and keep at the same time."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, wraps
from pathlib import Path
from types import ModuleType
from typing import Any


@cache
def load_librosa() -> ModuleType:
    """Return librosa, which is imported here and not before: it takes seconds, and few need it.

    It compiles functions when they are first used, and numba keeps them beside its source under an
    index that it reads, changes and writes without a lock. Two processes that do so at the same
    time leave an index that names the wrong function, and every later use ends in a segmentation
    fault (seen with librosa 0.11 and numba 0.68). So each look into these files, and each change of
    them, is made by one process at a time; what librosa computes is not.
    """
    from numba.core.caching import IndexDataCacheFile

    for name in ("load", "save"):
        setattr(IndexDataCacheFile, name, _alone(getattr(IndexDataCacheFile, name)))
    import librosa

    return librosa


def _alone(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return `function`, run while no other process of this user runs such a one."""

    @wraps(function)
    def run(*given: Any) -> Any:
        with _lock():
            return function(*given)

    return run


@contextmanager
def _lock() -> Iterator[None]:
    path = Path(tempfile.gettempdir()) / f"motionjury-{os.getuid()}-librosa.lock"
    lock = os.open(path, os.O_CREAT | os.O_RDWR | os.O_NOFOLLOW, 0o600)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
    finally:
        os.close(lock)
