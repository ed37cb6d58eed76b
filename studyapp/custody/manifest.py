"""What a backup says of itself, and which files of a study it holds, or at least knows.

The manifest is its first part, by which all others are checked.
"""

from __future__ import annotations

import hashlib
import os
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Annotated, Final, Literal

from pydantic import AfterValidator, AwareDatetime, BaseModel, ConfigDict, Field, model_validator

from studyapp.study.folder import StudyFolder

NAME: Final = "manifest.json"
DATABASE: Final = "responses.db"
"""The copy of the database; see `studyapp.database.copies`."""

SMALL_FILES: Final = (
    "study.toml",
    "stimuli.json",
    "pseudonyms.key",
    "recruitment.json",
    "published.json",
    "invitations.csv",
    "speech/segments.csv",
)
"""What is in every backup, where the study has it. All else that a study's folder holds is made
from these, the database and the media."""

MEDIA: Final = ("evaluators", "motion", "speech", "videos")
"""Folders of the media."""


def _belongs(path: str) -> str:
    """Refuse a path that leads anywhere but to a study's own files."""
    parts = PurePosixPath(path).parts
    if (
        path in (DATABASE, *SMALL_FILES)
        or (len(parts) > 1 and parts[0] in MEDIA and ".." not in parts and "\0" not in path)
    ) and path == "/".join(parts):
        return path
    raise ValueError(f"{path!r} is not a file of a study")


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


OnFile = Callable[[int, int], None]
"""Is told how many files are done, of how many."""


class StoredFile(_Part):
    """A file of the study.

    Attributes
    ----------
    path : str
        Relative to the study's folder.
    size : int
        Bytes.
    """

    path: Annotated[str, AfterValidator(_belongs)]
    size: Annotated[int, Field(ge=0)]
    sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]


class Manifest(_Part):
    """A backup's first part.

    Attributes
    ----------
    motionjury : str
        The version that made it.
    made_at : datetime
        Everything that was stored before is in it.
    origin : str
        Digest of where the study lay: tells backups of one study from those of another.
    schema_name : str
        Of the database.
    rows : mapping of str to int
        How many rows each of its tables has.
    files : tuple of StoredFile
        What is in the backup, in this order.
    media : tuple of StoredFile
        Media that the study had and that are not in the backup.
    """

    kind: Literal["motionjury backup"] = "motionjury backup"
    format: Literal[1] = 1
    motionjury: str
    made_at: AwareDatetime
    origin: str
    schema_name: str
    rows: dict[str, int]
    files: tuple[StoredFile, ...]
    media: tuple[StoredFile, ...] = ()

    @model_validator(mode="after")
    def _is_one_study(self) -> Manifest:
        paths = Counter(file.path for file in (*self.files, *self.media))
        if any(count > 1 for count in paths.values()):
            raise ValueError("a file is listed twice")
        if not {"study.toml", DATABASE} <= {file.path for file in self.files}:
            raise ValueError("the study file or the database is not listed")
        return self

    @property
    def participants(self) -> int:
        """How many study sessions there are."""
        return self.rows.get("study_sessions", 0)

    @property
    def answers(self) -> int:
        """How many answers there are."""
        return self.rows.get("responses", 0)

    @property
    def size(self) -> int:
        """Bytes of all files in the backup."""
        return sum(file.size for file in self.files)


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
