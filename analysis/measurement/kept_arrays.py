"""Arrays kept in a folder between runs, found again by what they were computed from.

A file's name tells the version of the code, the settings and the content that its array belongs to.
Several runs may share a folder: files appear in one step, and one that a second run removes or
damages is computed again.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from motion.files import replacing, sha256_of

Array = NDArray[np.float32]

_ENDING: Final = ".npy"


@dataclass(frozen=True)
class Kind:
    """Arrays of one kind.

    Attributes
    ----------
    name : str
        What the arrays are, in letters; kinds share a folder without meeting.
    version : str
        Raised whenever the code computes other values of the same file.
    shape : tuple of int or None
        What each array has; None for any length.
    """

    name: str
    version: str
    shape: tuple[int | None, ...]


class KeptArrays:
    """Arrays of files, computed once and kept.

    Parameters
    ----------
    folder : Path or None
        Made when the first array is kept; None keeps nothing.

    Attributes
    ----------
    used : set of Path
        Where all arrays lie that were asked for.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        self.used: set[Path] = set()

    def array(self, kind: Kind, source: Path, settings: str, compute: Callable[[], Array]) -> Array:
        """Return the array of a file, which is computed unless it is kept.

        Parameters
        ----------
        kind : Kind
            Which array.
        source : Path
            The file.
        settings : str
            All that it depends on besides.
        compute : callable
            Gives it.

        Raises
        ------
        InputError
            If the file cannot be read.
        """
        if self._folder is None:
            return compute()
        content = _content(source)
        place = self._folder / "-".join(
            (kind.name, _short(kind.version), _short(settings), content + _ENDING)
        )
        self.used.add(place)
        found = _read(place, kind)
        if found is None:
            found = compute()
            # A folder that cannot be written keeps nothing.
            with suppress(OSError), replacing(place) as draft, draft.open("wb") as file:
                np.save(file, found)
        return found


def forget_unused(used: Collection[Path]) -> None:
    """Remove what is kept under the settings of `used` but not in it, and of other versions."""
    parts = [tuple(place.name.split("-")) for place in used]
    kinds = {kind for kind, *_ in parts}
    versions = {part[:2] for part in parts}
    settings = {part[:3] for part in parts}
    for folder in {place.parent for place in used}:
        for path in folder.glob(f"*-*-*-*{_ENDING}"):
            found = tuple(path.name.split("-"))
            outdated = found[0] in kinds and found[:2] not in versions
            if outdated or (found[:3] in settings and path not in used):
                path.unlink(missing_ok=True)


def _read(place: Path, kind: Kind) -> Array | None:
    """Return what is kept at `place`; None where nothing whole of the kind's shape is."""
    try:
        kept = np.load(place, allow_pickle=False)
    except (OSError, ValueError, EOFError):
        return None
    fits = (
        kept.dtype == np.float32
        and kept.ndim == len(kind.shape)
        and all(want in (None, have) for want, have in zip(kind.shape, kept.shape, strict=True))
    )
    return np.asarray(kept) if fits else None


def _content(source: Path) -> str:
    try:
        found = source.stat()
        return _content_at(source, found.st_mtime_ns, found.st_size)
    except OSError as error:
        raise InputError(
            "the file cannot be read", where=source, remedy="Check the path"
        ) from error


@lru_cache(maxsize=8)
def _content_at(source: Path, changed: int, size: int) -> str:
    """Return the hash of a file's content; all kinds of arrays of a clip ask for it in turn."""
    return sha256_of(source)[:32]


def _short(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:12]
