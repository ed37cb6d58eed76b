"""The manifest of a backup: the files of a study that the backup holds.

All other files of a backup are checked against it.
"""

from __future__ import annotations

import hashlib
import os
from collections import Counter
from collections.abc import Callable, Iterator
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
"""In every backup, if the study has them. All other files of a study folder are made from these,
the database and the media."""

MEDIA: Final = ("evaluators", "motion", "speech", "videos")
"""Folders of media files."""


def _validate_path(path: str) -> str:
    """Refuse a path that is not one of a study's own files."""
    parts = PurePosixPath(path).parts
    if (
        path in (DATABASE, *SMALL_FILES)
        or (len(parts) > 1 and parts[0] in MEDIA and ".." not in parts and "\0" not in path)
    ) and path == "/".join(parts):
        return path
    raise ValueError(f"{path!r} is not a file of a study")


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


OnFile = Callable[[int, int], None]
"""Called with the number of finished files and of all files."""


class StoredFile(_Model):
    """A file of the study.

    Attributes
    ----------
    path : str
        Relative to the study's folder.
    size : int
        Bytes.
    """

    path: Annotated[str, AfterValidator(_validate_path)]
    size: Annotated[int, Field(ge=0)]
    sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]


class Manifest(_Model):
    """The manifest of a backup.

    Attributes
    ----------
    motionjury : str
        The version that made the backup.
    made_at : datetime
        Everything stored before is in the backup.
    origin : str
        Digest of the study's location, which distinguishes backups of different studies.
    rows : mapping of str to int
        Number of rows of each table.
    files : tuple of StoredFile
        The contents of the backup, in order.
    """

    kind: Literal["motionjury backup"] = "motionjury backup"
    format: Literal[1] = 1
    motionjury: str
    made_at: AwareDatetime
    origin: str
    rows: dict[str, int]
    files: tuple[StoredFile, ...]

    @model_validator(mode="after")
    def _check_files(self) -> Manifest:
        paths = Counter(file.path for file in self.files)
        if any(count > 1 for count in paths.values()):
            raise ValueError("a file is listed twice")
        if not {"study.toml", DATABASE} <= {file.path for file in self.files}:
            raise ValueError("the study file or the database is not listed")
        return self

    @property
    def participants(self) -> int:
        """The number of study sessions."""
        return self.rows.get("study_sessions", 0)

    @property
    def answers(self) -> int:
        """The number of answers."""
        return self.rows.get("responses", 0)

    @property
    def size(self) -> int:
        """Bytes of all files in the backup."""
        return sum(file.size for file in self.files)


Source = tuple[Path, StoredFile]
"""A file on this disk, and its entry in a manifest."""


def small_files(folder: StudyFolder) -> list[Source]:
    """Return the existing `SMALL_FILES`."""
    paths = ((folder.root / path, path) for path in SMALL_FILES)
    return [(source, stored_file(source, path)) for source, path in paths if source.is_file()]


def media_files(folder: StudyFolder, on_file: OnFile) -> list[Source]:
    """Return all media files, sorted by path; links are followed."""
    sources = sorted(
        source
        for name in MEDIA
        for source in _below(folder.root / name)
        if source.relative_to(folder.root).as_posix() not in SMALL_FILES
    )
    files = []
    for done, source in enumerate(sources, 1):
        files.append((source, stored_file(source, source.relative_to(folder.root).as_posix())))
        on_file(done, len(sources))
    return files


def stored_file(source: Path, path: str) -> StoredFile:
    """Return the entry of the file `source`, whose path in the study is `path`."""
    with source.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
        return StoredFile(path=path, size=stream.tell(), sha256=digest)


def _below(folder: Path) -> Iterator[Path]:
    """Yield all files below `folder`, without following circular links."""
    visited = {folder.resolve()}
    for parent, folders, files in os.walk(folder, followlinks=True):
        new = []
        for name in folders:
            target = (Path(parent) / name).resolve()
            if target not in visited:
                visited.add(target)
                new.append(name)
        folders[:] = new
        yield from (path for name in files if (path := Path(parent) / name).is_file())
