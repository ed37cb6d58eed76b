"""Which files a folder of recordings holds, and which of them belong together."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Final

from motion.errors import InputError

SOUND_ENDINGS: Final = (".wav", ".flac", ".mp3", ".m4a", ".ogg")
"""In the order in which they are preferred."""


@dataclass(frozen=True, kw_only=True)
class FolderFiles:
    """All files below a folder.

    Attributes
    ----------
    root : Path
        The folder.
    files : tuple of Path
        In order; hidden ones, and what lies in hidden folders, left out.
    """

    root: Path
    files: tuple[Path, ...]

    def ending_in(self, *endings: str) -> Iterator[Path]:
        """Yield the files with one of these endings, whatever their case."""
        return (path for path in self.files if path.suffix.lower() in endings)

    def place_of(self, path: Path) -> PurePosixPath:
        """Return where `path` lies below the folder."""
        return PurePosixPath(path.relative_to(self.root).as_posix())

    def companion(self, path: Path, endings: Iterable[str]) -> Path | None:
        """Return the file that has the name of `path` and one of `endings`.

        The first ending of which there is one beside `path`, or else one anywhere in the folder,
        as data sets keep sound and motion apart. None where there is none, or where several could
        be meant.
        """
        for ending in endings:
            named = self._by_name.get((path.stem, ending), [])
            beside = [other for other in named if other.parent == path.parent]
            if beside or len(named) == 1:
                return (beside or named)[0]
        return None

    @cached_property
    def _by_name(self) -> Mapping[tuple[str, str], list[Path]]:
        found: dict[tuple[str, str], list[Path]] = {}
        for path in self.files:
            found.setdefault((path.stem, path.suffix.lower()), []).append(path)
        return found


def list_folder(root: Path) -> FolderFiles:
    """Return all files below `root`; links to folders are followed, each folder once.

    Raises
    ------
    InputError
        If there is no such folder.
    """
    if not root.is_dir():
        raise InputError("there is no such folder of recordings", where=root, remedy="Check it")
    seen: set[str] = set()
    files: list[Path] = []
    for folder, below, names in os.walk(root, followlinks=True):
        real = os.path.realpath(folder)
        if real in seen:
            below.clear()
            continue
        seen.add(real)
        below[:] = sorted(name for name in below if not name.startswith("."))
        files += (Path(folder) / name for name in names if not name.startswith("."))
    return FolderFiles(root=root, files=tuple(sorted(files)))


def has_arrays(path: Path, *keys: str) -> bool:
    """Return whether an ``.npz`` file holds one of `keys`.

    Raises
    ------
    InputError
        If the file is no such archive.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            return any(f"{key}.npy" in archive.namelist() for key in keys)
    except (OSError, zipfile.BadZipFile) as error:
        raise InputError(
            "the file is not an .npz archive, or is truncated", where=path, remedy="Copy it again"
        ) from error
