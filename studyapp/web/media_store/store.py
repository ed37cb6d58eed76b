"""Where a participant's browser loads a video from, once it may."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Self
from urllib.parse import urlsplit

from motion.errors import InputError
from studyapp.session.served_study import ServedStudy
from studyapp.study.design.stimulus import Content
from studyapp.web.media_store.bucket import Bucket, connect
from studyapp.web.media_store.record import FILE, PublishedVideo, read_published

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
        signed = urlsplit(bucket.address(next(iter(videos.values())).names[0], SIGNED_SECONDS))
        return cls(bucket=bucket, origin=f"{signed.scheme}://{signed.netloc}", videos=videos)

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
        times = sum(self.videos.get(each) is video for each in earlier)
        if times >= len(video.names):
            return None
        return self.bucket.address(video.names[times], SIGNED_SECONDS)


def digests_of(served: ServedStudy) -> dict[Content, str]:
    """Return the SHA-256 of every video that a participant may be shown."""
    found = {}
    for content, video in served.videos.items():
        with video.file.open("rb") as stream:
            found[content] = hashlib.file_digest(stream, "sha256").hexdigest()
    return found
