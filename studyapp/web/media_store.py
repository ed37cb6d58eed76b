"""The store of videos: what was published, the bucket, and where a browser loads a video from.

What was published of a study is kept beside it, in ``published.json``. boto3 finds the keys in the
environment or in its own files; they never pass through here.
"""

from __future__ import annotations

import base64
import hashlib
import secrets
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self
from urllib.parse import urlsplit

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from motion.errors import InputError
from motion.files import sha256_of, write_text
from studyapp.boto_errors import as_input_errors
from studyapp.session.served_study import ServedStudy
from studyapp.study.design.trial import Content
from studyapp.study.settings.sections import explain_errors

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
            f"the file does not say what was published: {explain_errors(error)}",
            where=path,
            remedy="Bring it back from a backup, or remove it and publish again",
        ) from None


def write_published(root: Path, published: Published) -> None:
    """Keep what was published of the study in `root`."""
    write_text(root / FILE, published.model_dump_json(indent=1) + "\n")


SIGNED_SECONDS: Final = 900
"""How long an address of the store can be used."""

KEPT_SECONDS: Final = 300
"""How long a browser may keep it, so that what was fetched ahead is found again."""


@dataclass(frozen=True, kw_only=True)
class MediaStore:
    """The published videos of a study that is served.

    Attributes
    ----------
    bucket : Bucket
        Where they are.
    origin : str
        What all their addresses begin with, for the pages' policy.
    videos : mapping of Content to PublishedVideo
        Every video that a participant may be shown.
    """

    bucket: Bucket
    origin: str
    videos: Mapping[Content, PublishedVideo]

    @classmethod
    def of(cls, root: Path, served: ServedStudy) -> Self:
        """Return the store of the study in `root`.

        Raises
        ------
        InputError
            If a video was not published, or was made anew since; or there are no keys.
        """
        published = read_published(root)
        if published is None:
            raise InputError(
                "the videos were not published",
                where=root / FILE,
                remedy="Run 'motionjury publish-media', or serve them from this disk",
            )
        digests = digests_of(served)
        for content, digest in digests.items():
            if digest not in published.videos:
                raise InputError(
                    "the video is not in the store as it is here",
                    where=served.videos[content].file,
                    remedy="Run 'motionjury publish-media' again",
                )
        bucket = connect(published.place)
        videos = {content: published.videos[key] for content, key in digests.items()}
        # Signing one says at once whether there are keys.
        address = urlsplit(bucket.address(next(iter(videos.values())).names[0], SIGNED_SECONDS))
        return cls(bucket=bucket, origin=f"{address.scheme}://{address.netloc}", videos=videos)

    def address(self, content: Content, earlier: Sequence[Content]) -> str | None:
        """Return where `content` can be loaded for a while.

        Whoever saw it before gets another copy, whose name and bytes tell nothing of that.

        Parameters
        ----------
        earlier : sequence of Content
            All that the participant's videos before this one show.

        Returns
        -------
        str or None
            None where there are not that many copies.
        """
        video = self.videos[content]
        views = sum(self.videos.get(each) is video for each in earlier)
        if views >= len(video.names):
            return None
        return self.bucket.address(video.names[views], SIGNED_SECONDS)


def digests_of(served: ServedStudy) -> dict[Content, str]:
    """Return the SHA-256 of every video that a participant may be shown."""
    return {content: sha256_of(video.file) for content, video in served.videos.items()}


LOADED_AGAIN_SECONDS: Final = 3600
"""How long a browser may keep a video: it is named for one participant and one trial."""


class Bucket:
    """Access to the bucket at `place`.

    Parameters
    ----------
    connection : object
        boto3's client; see `connect`.
    """

    def __init__(self, connection: Any, place: Place) -> None:
        self._connection = connection
        self.place = place

    def put(self, name: str, content: bytes) -> None:
        """Store a video; the store refuses it if other bytes arrive."""
        digest = base64.b64encode(hashlib.md5(content, usedforsecurity=False).digest())
        with _as_input_errors(f"store {name}", self.place):
            self._connection.put_object(
                Bucket=self.place.bucket,
                Key=name,
                Body=content,
                ContentType="video/mp4",
                ContentMD5=digest.decode(),
                CacheControl=f"private, max-age={LOADED_AGAIN_SECONDS}",
            )

    def sizes(self) -> dict[str, int]:
        """Return the size of every object in the folder, by name."""
        with _as_input_errors("list what it holds", self.place):
            pages = self._connection.get_paginator("list_objects_v2")
            return {
                item["Key"]: item["Size"]
                for page in pages.paginate(Bucket=self.place.bucket, Prefix=self.place.folder)
                for item in page.get("Contents", ())
            }

    def address(self, name: str, seconds: int) -> str:
        """Return an address at which anybody can load an object for so many seconds.

        It is signed here; the store is not asked.
        """
        with _as_input_errors("sign an address", self.place):
            address: str = self._connection.generate_presigned_url(
                "get_object", Params={"Bucket": self.place.bucket, "Key": name}, ExpiresIn=seconds
            )
        return address


def connect(place: Place) -> Bucket:
    """Return access to the bucket at `place`.

    Raises
    ------
    InputError
        If boto3 is not installed, or finds no region.
    """
    try:
        import boto3
        from botocore.config import Config
    except ImportError:
        raise InputError(
            "videos in a store need boto3, which is not installed",
            remedy="Install it with 'pip install motionjury[s3]'",
        ) from None
    config = Config(
        signature_version="s3v4",
        # Stores that know no virtual hosts have an address of their own.
        s3={"addressing_style": "path" if place.endpoint else "virtual"},
        # Others than Amazon's know the MD5 alone.
        request_checksum_calculation="when_required",
        response_checksum_validation="when_required",
    )
    with _as_input_errors("be reached", place):
        client = boto3.client(
            "s3",
            endpoint_url=place.endpoint or None,
            region_name=place.region or None,
            config=config,
        )
    return Bucket(client, place)


def _as_input_errors(what: str, place: Place) -> AbstractContextManager[None]:
    return as_input_errors(
        "the store",
        what,
        correct="Correct what it names, and run the same command again",
        check="the network, the endpoint and the region",
        where=f"{place.endpoint or 'S3'}, bucket {place.bucket}",
    )
