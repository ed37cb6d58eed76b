"""Arrays kept in a folder between runs, under a name that identifies their origin.

A file's name gives the version of the code, the settings and the content of the source. Several
runs may share a folder: files appear in one step, and an array that another run removes or damages
is computed again.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np

from motion.arrays import Floats32
from motion.errors import InputError
from motion.files import replacing, sha256_of

_EXTENSION: Final = ".npy"


@dataclass(frozen=True)
class Kind:
    """Arrays of one kind.

    Attributes
    ----------
    name : str
        Letters; the start of their file names.
    version : str
        Raised whenever the code computes different values from the same file.
    shape : tuple of int or None
        Shape of each array; None for any length.
    """

    name: str
    version: str
    shape: tuple[int | None, ...]


class KeptArrays:
    """Arrays computed from files, once, and kept.

    Parameters
    ----------
    folder : Path or None
        Created with the first array; None keeps nothing.

    Attributes
    ----------
    used : set of Path
        Paths of all arrays that were requested.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self.used: set[Path] = set()

    def array(
        self, kind: Kind, sources: Sequence[Path], settings: str, compute: Callable[[], Floats32]
    ) -> Floats32:
        """Return an array of one file or several, computed unless it is kept.

        Parameters
        ----------
        kind : Kind
            The kind of array.
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
        if self._folder is None:
            return compute()
        content = "".join(map(_content, sources))
        path = self._folder / "-".join(
            (kind.name, _short(kind.version), _short(settings), content + _EXTENSION)
        )
        self.used.add(path)
        array = _read(path, kind)
        if array is None:
            array = compute()
            # A folder that cannot be written keeps nothing.
            with suppress(OSError), replacing(path) as draft, draft.open("wb") as file:
                np.save(file, array)
        return array


def forget_unused(used: Collection[Path]) -> None:
    """Remove unused arrays with the settings of `used` ones, and those of other versions."""
    parts = [tuple(path.name.split("-")) for path in used]
    kinds = {kind for kind, *_ in parts}
    versions = {part[:2] for part in parts}
    settings = {part[:3] for part in parts}
    for folder in {path.parent for path in used}:
        for path in folder.glob(f"*-*-*-*{_EXTENSION}"):
            part = tuple(path.name.split("-"))
            is_outdated = part[0] in kinds and part[:2] not in versions
            if is_outdated or (part[:3] in settings and path not in used):
                path.unlink(missing_ok=True)


def _read(path: Path, kind: Kind) -> Floats32 | None:
    """Return the array at `path`; None if it is missing, damaged or of another shape."""
    try:
        array = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError):
        return None
    fits = (
        array.dtype == np.float32
        and array.ndim == len(kind.shape)
        and all(size in (None, n) for size, n in zip(kind.shape, array.shape, strict=True))
    )
    return np.asarray(array) if fits else None


def _content(source: Path) -> str:
    try:
        status = source.stat()
        return _content_hash(source, status.st_mtime_ns, status.st_size)
    except OSError as error:
        raise InputError(
            "the file cannot be read", where=source, remedy="Check the path"
        ) from error


@lru_cache(maxsize=8)
def _content_hash(source: Path, modified: int, size: int) -> str:
    """Return the hash of a file's content, read once for all kinds of arrays of a clip."""
    return sha256_of(source)[:32]


def _short(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:12]
