"""The files of a folder of recordings, and the takes found in it before they are split."""

import hashlib
import os
import re
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Final

from motion.errors import InputError
from training.data.take import Split, Take


@dataclass(frozen=True, kw_only=True)
class FolderFiles:
    """All files below a folder.

    Attributes
    ----------
    root : Path
        The folder.
    files : tuple of Path
        Sorted paths, without hidden files and folders.
    """

    root: Path
    files: tuple[Path, ...]

    def ending_in(self, *endings: str) -> Iterator[Path]:
        """Yield the files with one of `endings`, whatever their case."""
        return (path for path in self.files if path.suffix.lower() in endings)

    def place_of(self, path: Path) -> PurePosixPath:
        """Return the path of a file relative to the folder."""
        return PurePosixPath(path.relative_to(self.root).as_posix())

    def companion(self, path: Path, endings: Iterable[str]) -> Path | None:
        """Return the file with the stem of `path` and the first of `endings` that exists.

        It is next to `path` or anywhere in the folder, since data sets separate sound and motion.
        None if there is no such file, or several outside the folder of `path`.
        """
        for ending in endings:
            candidates = self._by_name.get((path.stem, ending), [])
            siblings = [candidate for candidate in candidates if candidate.parent == path.parent]
            if siblings or len(candidates) == 1:
                return (siblings or candidates)[0]
        return None

    @cached_property
    def _by_name(self) -> Mapping[tuple[str, str], list[Path]]:
        by_name: dict[tuple[str, str], list[Path]] = {}
        for path in self.files:
            by_name.setdefault((path.stem, path.suffix.lower()), []).append(path)
        return by_name


def list_folder(root: Path) -> FolderFiles:
    """Return all files below `root`; links to folders are followed once.

    Raises
    ------
    InputError
        If there is no such folder.
    """
    if not root.is_dir():
        raise InputError("there is no such folder of recordings", where=root, remedy="Check it")
    seen: set[str] = set()
    files: list[Path] = []
    for folder, subfolders, names in os.walk(root, followlinks=True):
        real = os.path.realpath(folder)
        if real in seen:
            subfolders.clear()
            continue
        seen.add(real)
        subfolders[:] = sorted(name for name in subfolders if not name.startswith("."))
        files += (Path(folder) / name for name in names if not name.startswith("."))
    return FolderFiles(root=root, files=tuple(sorted(files)))


def has_arrays(path: Path, *keys: str) -> bool:
    """Return whether an ``.npz`` file has one of `keys`; a damaged one has none."""
    try:
        with zipfile.ZipFile(path) as archive:
            return any(f"{key}.npy" in archive.namelist() for key in keys)
    except (OSError, zipfile.BadZipFile):
        return False


SPLIT_WORDS: Final[dict[str, Split]] = {
    "train": "train",
    "training": "train",
    "val": "validation",
    "valid": "validation",
    "validation": "validation",
    "dev": "validation",
    "test": "test",
    "testing": "test",
}
"""Data sets' names of the splits, in lower case."""

_LONGEST_NAME: Final = 100


@dataclass(frozen=True, kw_only=True)
class FoundTake:
    """A take whose split is undecided, with the facts that may decide it.

    Attributes
    ----------
    take : Take
        The take, with a provisional split.
    place : str
        Its path in the folder, without its ending and the folder of a split. A split list may use
        it instead of the name.
    recording : str
        The recording that it was cut from; takes of one recording belong to one split.
    given_split : {'train', 'validation', 'test'} or None
        The data set's own split, by a folder or a published rule.
    """

    take: Take
    place: str
    recording: str
    given_split: Split | None = None


def split_folder(place: PurePosixPath) -> tuple[PurePosixPath, Split | None]:
    """Return `place` without a folder that names a split, and that split."""
    for index, part in enumerate(place.parts[:-1]):
        if part.lower() in SPLIT_WORDS:
            remaining = PurePosixPath(*place.parts[:index], *place.parts[index + 1 :])
            return remaining, SPLIT_WORDS[part.lower()]
    return place, None


def usable_name(text: str) -> str:
    """Return `text` as a safe file name; if it had to be changed, with a hash of it."""
    name = re.sub(r"[^A-Za-z0-9_.-]+", "_", text).lstrip("_.-")
    if name == text and len(name) <= _LONGEST_NAME:
        return name
    mark = hashlib.sha256(text.encode()).hexdigest()[:8]
    return f"{name[: _LONGEST_NAME - 9] or 'take'}-{mark}"
