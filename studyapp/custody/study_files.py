"""Which files of a study's folder a backup holds, or at least knows."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from studyapp.custody.archive import OnFile
from studyapp.custody.manifest import MEDIA, SMALL_FILES, StoredFile
from studyapp.study.folder import StudyFolder


@dataclass(frozen=True, kw_only=True)
class FoundFile:
    """A file on this disk, and what a manifest says of it."""

    source: Path
    entry: StoredFile


def small_files(folder: StudyFolder) -> list[FoundFile]:
    """Return what is in every backup; see `studyapp.custody.manifest.SMALL_FILES`."""
    return [
        found_file(folder.root / path, path)
        for path in SMALL_FILES
        if (folder.root / path).is_file()
    ]


def media_files(folder: StudyFolder, on_file: OnFile) -> list[FoundFile]:
    """Return every file of the media, sorted by path; links count as what they lead to."""
    paths = sorted(
        path
        for name in MEDIA
        for path in _below(folder.root / name)
        if path.relative_to(folder.root).as_posix() not in SMALL_FILES
    )
    found = []
    for done, path in enumerate(paths, 1):
        found.append(found_file(path, path.relative_to(folder.root).as_posix()))
        on_file(done, len(paths))
    return found


def found_file(source: Path, path: str) -> FoundFile:
    """Return the file `source`, which is called `path` in the study."""
    with source.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
        entry = StoredFile(path=path, size=stream.tell(), sha256=digest)
    return FoundFile(source=source, entry=entry)


def media_amiss(root: Path, media: tuple[StoredFile, ...]) -> tuple[list[str], list[str]]:
    """Return which of `media` are missing in the study at `root`, and which are other ones."""
    missing, other = [], []
    for entry in media:
        place = root / entry.path
        if not place.is_file():
            missing.append(entry.path)
        elif place.stat().st_size != entry.size or found_file(place, entry.path).entry != entry:
            other.append(entry.path)
    return missing, other


def _below(folder: Path) -> Iterator[Path]:
    """Yield all files below `folder`; a folder that leads back to one above is left out."""
    above = {folder.resolve()}
    for where, folders, files in os.walk(folder, followlinks=True):
        kept = []
        for name in folders:
            real = (Path(where) / name).resolve()
            if real not in above:
                above.add(real)
                kept.append(name)
        folders[:] = kept
        yield from (path for name in files if (path := Path(where) / name).is_file())
