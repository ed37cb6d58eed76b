"""Arrays kept in a folder between runs, found again by what they were computed from.

A file's name tells the version of the code, the settings and the content that its array belongs to.
Several runs may share a folder: files appear in one step, and one that a second run removes or
damages is computed again.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from motion.files import replacing

_ENDING: Final = ".npy"


class KeptArrays:
    """Arrays of one kind and one version of the code that computes them.

    Parameters
    ----------
    folder : Path
        Made when the first array is kept.
    kind : str
        What the arrays are, in letters; kinds share a folder without meeting.
    version : str
        Changes whenever the code may compute other values.
    """

    def __init__(self, folder: Path, kind: str, version: str) -> None:
        self.folder = folder
        self._kind = kind
        self._version = _short(version)

    def place(self, source: Path, settings: str) -> Path:
        """Return where the array of file `source` under `settings` is kept, there or not.

        Raises
        ------
        InputError
            If the file cannot be read.
        """
        try:
            content = hashlib.sha256(source.read_bytes()).hexdigest()[:32]
        except OSError as error:
            raise InputError(
                "the motion file cannot be read", where=source, remedy="Check the path"
            ) from error
        return self.folder / f"{self._prefix(settings)}{content}{_ENDING}"

    @staticmethod
    def read(place: Path, shape: Sequence[int | None]) -> NDArray[np.float32] | None:
        """Return what is kept at `place`; None where nothing whole of that shape is.

        Parameters
        ----------
        place : Path
            As `place` returned it.
        shape : sequence of int or None
            What the array must have; None for any length.
        """
        try:
            kept = np.load(place, allow_pickle=False)
        except (OSError, ValueError, EOFError):
            return None
        fits = kept.dtype == np.float32 and kept.ndim == len(shape)
        if not fits or any(
            want not in (None, have) for want, have in zip(shape, kept.shape, strict=True)
        ):
            return None
        return np.asarray(kept)

    @staticmethod
    def keep(place: Path, values: NDArray[np.float32]) -> None:
        """Keep `values` at `place`, in one step; a folder that cannot be written keeps nothing."""
        with suppress(OSError), replacing(place) as draft, draft.open("wb") as file:
            np.save(file, values)

    def forget(self, settings: str, used: Collection[Path]) -> None:
        """Remove what is kept under `settings` but not `used`, and all of other versions."""
        self.forget_versions()
        for path in self.folder.glob(f"{self._prefix(settings)}*{_ENDING}"):
            if path not in used:
                path.unlink(missing_ok=True)

    def forget_versions(self) -> None:
        """Remove what other versions of the code have kept."""
        for path in self.folder.glob(f"{self._kind}-*{_ENDING}"):
            if not path.name.startswith(f"{self._kind}-{self._version}-"):
                path.unlink(missing_ok=True)

    def _prefix(self, settings: str) -> str:
        return f"{self._kind}-{self._version}-{_short(settings)}-"


def _short(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:12]
