"""A bucket of an S3-compatible store, as far as videos need it.

boto3 finds the keys in the environment or in its own files; they never pass through here.
"""

from __future__ import annotations

import base64
import hashlib
from contextlib import AbstractContextManager
from typing import Any, Final

from motion.errors import InputError
from studyapp.boto_errors import said_plainly
from studyapp.web.media_store.record import Place

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
        with _said_plainly(f"store {name}", self.place):
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
        with _said_plainly("list what it holds", self.place):
            pages = self._connection.get_paginator("list_objects_v2")
            return {
                found["Key"]: found["Size"]
                for page in pages.paginate(Bucket=self.place.bucket, Prefix=self.place.folder)
                for found in page.get("Contents", ())
            }

    def delete(self, name: str) -> None:
        """Remove an object; one that is not there is no error."""
        with _said_plainly(f"delete {name}", self.place):
            self._connection.delete_object(Bucket=self.place.bucket, Key=name)

    def allow(self, origin: str) -> None:
        """Let pages of `origin` load from the bucket, beside those that may already."""
        from botocore.exceptions import ClientError

        rule = {
            "AllowedOrigins": [origin],
            "AllowedMethods": ["GET", "HEAD"],
            "AllowedHeaders": ["Range"],
            "MaxAgeSeconds": LOADED_AGAIN_SECONDS,
        }
        with _said_plainly(f"let pages of {origin} load from it", self.place):
            try:
                rules = self._connection.get_bucket_cors(Bucket=self.place.bucket)["CORSRules"]
            except ClientError as error:
                if error.response.get("Error", {}).get("Code") != "NoSuchCORSConfiguration":
                    raise
                rules = []
            self._connection.put_bucket_cors(
                Bucket=self.place.bucket, CORSConfiguration={"CORSRules": [*rules, rule]}
            )

    def address(self, name: str, seconds: int) -> str:
        """Return an address at which anybody can load an object for so many seconds.

        It is signed here; the store is not asked.
        """
        with _said_plainly("sign an address", self.place):
            signed: str = self._connection.generate_presigned_url(
                "get_object", Params={"Bucket": self.place.bucket, "Key": name}, ExpiresIn=seconds
            )
        return signed


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
    with _said_plainly("be reached", place):
        client = boto3.client(
            "s3",
            endpoint_url=place.endpoint or None,
            region_name=place.region or None,
            config=config,
        )
    return Bucket(client, place)


def _said_plainly(what: str, place: Place) -> AbstractContextManager[None]:
    return said_plainly(
        "the store",
        what,
        correct="Correct what it names, and run the same command again",
        check="the network, the endpoint and the region",
        where=f"{place.endpoint or 'S3'}, bucket {place.bucket}",
    )
