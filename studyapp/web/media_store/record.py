"""What was published of a study's videos, kept beside it: ``published.json``."""

from __future__ import annotations

import secrets
from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from motion.errors import InputError
from motion.files import write_text
from studyapp.study.settings.validation import explain

FILE: Final = "published.json"
_NAME_BYTES: Final = 16


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Place(_Part):
    """Where in which store the videos are.

    Attributes
    ----------
    bucket : str
    folder : str
        What all names begin with, ending in a slash; or empty.
    endpoint : str
        The store's address; empty for Amazon's.
    region : str
        Empty for the one that the environment names.
    """

    bucket: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9.-]{1,61}[a-z0-9]$")]
    folder: Annotated[str, Field(pattern=r"^([A-Za-z0-9_-][A-Za-z0-9._-]*/)*$")] = ""
    endpoint: str = ""
    region: str = ""


class PublishedVideo(_Part):
    """One video file in the store.

    Attributes
    ----------
    size : int
        Bytes of each of its copies.
    names : tuple of str
        Random, one for each copy: whoever sees the video again sees another one.
    """

    size: int
    names: tuple[str, ...]


class Published(_Part):
    """All videos that were published.

    Attributes
    ----------
    videos : mapping of str to PublishedVideo
        By the SHA-256 of the study's own file.
    """

    format: Literal[1] = 1
    place: Place
    videos: dict[str, PublishedVideo] = {}


def new_name(place: Place) -> str:
    """Draw a name, which tells nothing and is as long as every other one."""
    return f"{place.folder}{secrets.token_hex(_NAME_BYTES)}.mp4"


def read_published(root: Path) -> Published | None:
    """Return what was published of the study in `root`; None where nothing was.

    Raises
    ------
    InputError
        If the file is damaged.
    """
    path = root / FILE
    try:
        return Published.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        return None
    except ValidationError as error:
        raise InputError(
            f"the file does not say what was published: {explain(error)}",
            where=path,
            remedy="Bring it back from a backup, or remove it and publish again",
        ) from None


def write_published(root: Path, published: Published) -> None:
    """Keep what was published of the study in `root`."""
    write_text(root / FILE, published.model_dump_json(indent=1) + "\n")
