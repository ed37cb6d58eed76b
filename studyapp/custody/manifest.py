"""What a backup says of itself: its first part, by which all others are checked."""

from __future__ import annotations

from collections import Counter
from pathlib import PurePosixPath
from typing import Annotated, Final, Literal

from pydantic import AfterValidator, AwareDatetime, BaseModel, ConfigDict, Field, model_validator

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
