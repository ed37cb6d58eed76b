"""Arrays kept in a folder between runs, under a name that identifies their origin.

A file's name gives the kind with its version, the settings and the content of the sources. Several
runs may share a folder: files appear in one step, and an array that another run removes or damages
is computed again.
"""

import hashlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

import numpy as np

from motion.arrays import Floats32
from motion.errors import InputError
from motion.files import replacing, sha256_of


def kept_array(
    folder: Path | None,
    kind: str,
    sources: Sequence[Path],
    settings: str,
    compute: Callable[[], Floats32],
) -> Floats32:
    """Return an array of one file or several, computed unless it is kept.

    Parameters
    ----------
    folder : Path or None
        Created with the first array; None keeps nothing.
    kind : str
        The kind of array, with a version that is raised whenever the code computes different values
        from the same file.
    sources : sequence of Path
        The files.
    settings : str
        Everything else that the array depends on.
    compute : callable
        Computes the array.

    Raises
    ------
    InputError
        If a file cannot be read.
    """
    if folder is None:
        return compute()
    key = " ".join((settings, *map(_content, sources)))
    path = folder / f"{kind}-{hashlib.sha256(key.encode()).hexdigest()[:40]}.npy"
    with suppress(OSError, ValueError, EOFError):
        return np.asarray(np.load(path, allow_pickle=False), np.float32)
    array = compute()
    # A folder that cannot be written keeps nothing.
    with suppress(OSError), replacing(path) as draft, draft.open("wb") as file:
        np.save(file, array)
    return array


def _content(source: Path) -> str:
    try:
        status = source.stat()
        return _content_hash(source, status.st_mtime_ns, status.st_size)
    except OSError as error:
        raise InputError(
            "the file cannot be read", where=source, remedy="Check the path"
        ) from error


@lru_cache(maxsize=16)
def _content_hash(source: Path, modified: int, size: int) -> str:
    """Return the hash of a file's content, read once for all kinds of arrays of a clip."""
    return sha256_of(source)
