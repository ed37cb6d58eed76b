"""Uploading a study's videos to an S3-compatible store, from which participants load them.

A participant may see a video twice, as practice and again at the end. Each time it is another copy
in the store, with another name and other bytes behind its end, since stores send a digest of every
object to browsers. Copies are uploaded in random order, so their age reveals nothing.
"""

import secrets
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import httpx

from motion.errors import InputError
from studyapp.session.served_study import ServedStudy
from studyapp.study.design.trial import Content
from studyapp.study.folder import StudyFolder
from studyapp.web.media_store import (
    FILE,
    SIGNED_SECONDS,
    Bucket,
    Place,
    Published,
    PublishedVideo,
    connect,
    digests_of,
    new_name,
    read_published,
    write_published,
)

MARK_BYTES: Final = 24
"""Size of the box behind the end, which players skip: 8 bytes of header and 16 at random."""

SAMPLED_PLACES: Final = 200
"""Places of each arm whose trials are planned to find how often a participant sees a video."""

TIMEOUT_SECONDS: Final = 30.0


@dataclass(frozen=True, kw_only=True)
class Publication:
    """The result of an upload.

    Attributes
    ----------
    stored, kept : int
        Copies that were uploaded, and that were already there.
    """

    stored: int
    kept: int


def publish(
    folder: StudyFolder, place: Place | None, on_file: Callable[[int, int], None]
) -> Publication:
    """Upload all videos that participants may see, except for those already in the store.

    Those are recognised by name and size: names are random and kept in ``published.json`` before
    the upload, and an object appears in a store completely or not at all.

    Parameters
    ----------
    place : Place or None
        None for the place of the previous upload.
    on_file : callable
        Called with (uploaded copies, all copies to upload).

    Raises
    ------
    InputError
        If videos are missing, or the store refuses.
    """
    served = ServedStudy.read(folder.root)
    before = read_published(folder.root)
    place = place or (before.place if before is not None else None)
    if place is None:
        raise InputError(
            "no bucket was given",
            where=folder.root / FILE,
            remedy="Give the bucket, such as s3://my-bucket/my-study",
        )
    digests = digests_of(served)
    files = {digest: served.videos[content].file for content, digest in digests.items()}
    sizes = {digest: path.stat().st_size + MARK_BYTES for digest, path in files.items()}
    published = _assign_names(before, place, sizes, _most_views(served, digests))
    write_published(folder.root, published)
    bucket = connect(place)
    existing = bucket.sizes()
    copies = {name: digest for digest, video in published.videos.items() for name in video.names}
    missing = [name for name, digest in copies.items() if existing.get(name) != sizes[digest]]
    secrets.SystemRandom().shuffle(missing)
    for done, name in enumerate(missing, 1):
        bucket.put(name, files[copies[name]].read_bytes() + _random_box())
        on_file(done, len(missing))
    return Publication(stored=len(missing), kept=len(copies) - len(missing))


def require_loading(folder: StudyFolder, origin: str) -> None:
    """Load a piece of a video from the store, as browsers do on pages of `origin`.

    Raises
    ------
    InputError
        If it cannot be loaded, pages of `origin` may not use it, or it needs no signature.
    """
    published = read_published(folder.root)
    if published is None or not published.videos:
        raise InputError(
            "no videos were published", where=folder.root / FILE, remedy="Publish the videos first"
        )
    bucket, name = connect(published.place), next(iter(published.videos.values())).names[0]
    signed = bucket.address(name, SIGNED_SECONDS)
    headers = {"Range": "bytes=0-1", "Origin": origin}
    try:
        with httpx.Client(timeout=TIMEOUT_SECONDS) as client:
            partial = client.get(signed, headers=headers)
            unsigned = client.get(signed.partition("?")[0], headers=headers)
    except httpx.HTTPError as error:
        raise _store_error(bucket, f"it cannot be reached ({type(error).__name__})") from None
    if unsigned.is_success:
        raise _store_error(bucket, "anybody can load from it without a signed address")
    if partial.status_code != httpx.codes.PARTIAL_CONTENT or len(partial.content) != 2:
        raise _store_error(bucket, f"it sends no byte ranges (status {partial.status_code})")
    if partial.headers.get("Access-Control-Allow-Origin") not in (origin, "*"):
        raise _store_error(bucket, f"it does not let pages of {origin} load from it (CORS)")


def _most_views(served: ServedStudy, digests: Mapping[Content, str]) -> int:
    """Return how often a participant sees the same file at most."""
    most = 1
    for arm in served.study.arms:
        for number in range(min(arm.places, SAMPLED_PLACES)):
            seen = Counter(
                digests[content]
                for trial in served.study.plan(arm, number, served.segments)
                for content in trial.shown
            )
            most = max(most, *seen.values())
    return most


def _assign_names(
    before: Published | None, place: Place, sizes: Mapping[str, int], times: int
) -> Published:
    """Return all videos with as many names as needed.

    Names are kept only if all can be. Otherwise, objects uploaded later would be recognisable by
    their age, which stores publish, as videos of an added condition or as second copies.
    """
    if before is not None and before.place == place:
        videos = {digest: before.videos.get(digest) for digest in sizes}
        if all(
            video is not None and video.size == sizes[digest] and len(video.names) >= times
            for digest, video in videos.items()
        ):
            return before
    return Published(
        place=place,
        videos={
            digest: PublishedVideo(size=size, names=tuple(new_name(place) for _ in range(times)))
            for digest, size in sizes.items()
        },
    )


def _random_box() -> bytes:
    return MARK_BYTES.to_bytes(4, "big") + b"free" + secrets.token_bytes(MARK_BYTES - 8)


def _store_error(bucket: Bucket, what: str) -> InputError:
    return InputError(
        what,
        where=f"{bucket.place.endpoint or 'S3'}, bucket {bucket.place.bucket}",
        remedy="Set the bucket as docs/media-store.md says, and run the command again",
    )
