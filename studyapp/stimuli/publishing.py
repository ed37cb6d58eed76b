"""Bringing a study's videos into an S3-compatible store, so that participants load them there.

A participant may see a video twice, as practice and again at the end. Each time it is another copy
in the store: of another name, and with other bytes behind its end, since stores tell browsers a
digest of what they send. Copies are stored in random order, so that their age tells nothing.
"""

from __future__ import annotations

import secrets
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
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
"""A box behind the end that players pass over, as long in every file: eight bytes of head and
sixteen at random."""

PLACES: Final = 200
"""Places of each arm whose trials are planned, to see how often anybody sees one video."""

WAIT_SECONDS: Final = 30.0


@dataclass(frozen=True, kw_only=True)
class Publication:
    """What a run did.

    Attributes
    ----------
    stored, kept : int
        Copies that were stored, and those that were there.
    unused : tuple of str
        Names in the folder that belong to no video of now.
    """

    stored: int
    kept: int
    unused: tuple[str, ...]


def publish(
    folder: StudyFolder, place: Place | None, on_file: Callable[[int, int], None]
) -> Publication:
    """Store every video that participants may be shown, but for those that are there.

    What is there is told by name and size: names are random, kept in ``published.json`` before
    anything is stored under them, and an object appears in a store whole or not at all.

    Parameters
    ----------
    place : Place or None
        None for where they were published before.
    on_file : callable
        Is told how many copies are stored, of how many.

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
            "nobody has said where to publish to",
            where=folder.root / FILE,
            remedy="Give the bucket, such as s3://my-bucket/my-study",
        )
    digests = digests_of(served)
    files = {digest: served.videos[content].file for content, digest in digests.items()}
    sizes = {digest: path.stat().st_size + MARK_BYTES for digest, path in files.items()}
    published = _named(before, place, sizes, _most_times(served, digests))
    write_published(folder.root, published)
    bucket = connect(place)
    there = bucket.sizes()
    wanted = {name: digest for digest, video in published.videos.items() for name in video.names}
    to_do = [name for name, digest in wanted.items() if there.get(name) != sizes[digest]]
    secrets.SystemRandom().shuffle(to_do)
    for done, name in enumerate(to_do, 1):
        bucket.put(name, files[wanted[name]].read_bytes() + _mark())
        on_file(done, len(to_do))
    return Publication(
        stored=len(to_do),
        kept=len(wanted) - len(to_do),
        unused=tuple(sorted(there.keys() - wanted.keys())),
    )


def remove(folder: StudyFolder, names: Sequence[str]) -> None:
    """Remove from the store what a publication found unused.

    Raises
    ------
    InputError
        If the study has no folder of its own there: all else in the bucket would be removed.
    """
    bucket = _bucket_of(folder)[0]
    if not bucket.place.folder:
        raise _amiss(bucket, "all that is in the bucket and is no video of now would be removed")
    for name in names:
        bucket.delete(name)


def let_in(folder: StudyFolder, origin: str) -> None:
    """See to it that participants' browsers on pages of `origin` can load from the store.

    Raises
    ------
    InputError
        If a piece of a video cannot be loaded as they will, or anybody can load it unsigned.
    """
    bucket, name = _bucket_of(folder)
    if not _may_load(bucket, name, origin):
        bucket.allow(origin)
        if not _may_load(bucket, name, origin):
            raise _amiss(bucket, f"it does not let pages of {origin} load from it (CORS)")


def _may_load(bucket: Bucket, name: str, origin: str) -> bool:
    """Load a piece of a video as a browser does, and tell whether its page may have it."""
    signed = bucket.address(name, SIGNED_SECONDS)
    asked = {"Range": "bytes=0-1", "Origin": origin}
    try:
        with httpx.Client(timeout=WAIT_SECONDS) as client:
            piece = client.get(signed, headers=asked)
            unsigned = client.get(signed.partition("?")[0], headers=asked)
    except httpx.HTTPError as error:
        raise _amiss(bucket, f"it cannot be reached ({type(error).__name__})") from None
    if unsigned.is_success:
        raise _amiss(bucket, "anybody can load from it, without a signed address")
    if piece.status_code != httpx.codes.PARTIAL_CONTENT or len(piece.content) != 2:
        raise _amiss(bucket, f"it sends no part of a video (status {piece.status_code})")
    return piece.headers.get("Access-Control-Allow-Origin") in (origin, "*")


def _bucket_of(folder: StudyFolder) -> tuple[Bucket, str]:
    """Return the bucket of what was published, and the name of one video in it."""
    published = read_published(folder.root)
    if published is None or not published.videos:
        raise InputError(
            "nothing was published", where=folder.root / FILE, remedy="Publish the videos first"
        )
    return connect(published.place), next(iter(published.videos.values())).names[0]


def _most_times(served: ServedStudy, digests: Mapping[Content, str]) -> int:
    """Return how often anybody is shown the same file."""
    most = 1
    for arm in served.study.arms:
        for number in range(min(arm.places, PLACES)):
            seen = Counter(
                digests[content]
                for trial in served.study.plan(arm, number, served.segments)
                for content in trial.shown
            )
            most = max(most, *seen.values())
    return most


def _named(
    before: Published | None, place: Place, sizes: Mapping[str, int], times: int
) -> Published:
    """Return every video with as many names as it needs.

    Names stay only where all of them do. What is stored later than the rest would be told by its
    age, which stores say: as the video of a condition that was added, or as a second copy.
    """
    if before is not None and before.place == place:
        known = {digest: before.videos.get(digest) for digest in sizes}
        if all(
            video is not None and video.size == sizes[digest] and len(video.names) >= times
            for digest, video in known.items()
        ):
            return before
    return Published(
        place=place,
        videos={
            digest: PublishedVideo(size=size, names=tuple(new_name(place) for _ in range(times)))
            for digest, size in sizes.items()
        },
    )


def _mark() -> bytes:
    return MARK_BYTES.to_bytes(4, "big") + b"free" + secrets.token_bytes(MARK_BYTES - 8)


def _amiss(bucket: Bucket, what: str) -> InputError:
    return InputError(
        what,
        where=f"{bucket.place.endpoint or 'S3'}, bucket {bucket.place.bucket}",
        remedy="Correct the bucket's settings, and run the same command again",
    )
