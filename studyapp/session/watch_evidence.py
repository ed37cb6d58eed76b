"""Watch evidence: what the reports of a browser prove to have been watched, judged here.

A report tells of one stretch of playing, all of it alike: as recorded or faster, in view or not,
heard or not. Only what was played no faster than recorded, in view, and heard where there is
something to hear counts as watched, and nothing of a video that the server never sent.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from operator import itemgetter
from typing import Annotated, ClassVar, Final, Protocol

from pydantic import AfterValidator, ConfigDict, Field, TypeAdapter

from studyapp.database.tables import Trial, Video

Interval = tuple[float, float]

MAX_RATE: Final = 1.05
"""Playback rate up to which a video counts as played as it was recorded."""

MAX_REPORTS: Final = 1000
"""Reports of one video that are taken: half an hour of playing it."""

MAX_INTERVALS: Final = 200
"""Parts that a report may tell of, and that the watched ones of a video may be in."""

MEDIA_ERRORS: Final = ("2", "3", "4")
"""A browser's codes for a video that it could not fetch, decode or play at all."""

LONG_STALL: Final = 4.0
"""Seconds without data after which a video counts as stalled; its page says so after five."""

REMEMBERED_REPORTS: Final = 32
"""Reports by which one that is sent again is known; each is sent until it is acknowledged."""


def _runs_forward(interval: Interval) -> Interval:
    start, end = interval
    if start > end:
        raise ValueError("an interval ends before it begins")
    return interval


Seconds = Annotated[float, Field(ge=0, le=86_400, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=0, le=10_000_000, strict=True)]
PlayedInterval = Annotated[tuple[Seconds, Seconds], AfterValidator(_runs_forward)]


@dataclass(frozen=True, kw_only=True)
class Playback:
    """How a stretch of a video played, as a browser reports it.

    Attributes
    ----------
    rate : float
        Largest playback rate seen; 1 is as recorded.
    hidden_seconds, silent_seconds : float
        How long it played where nobody could see it, and where nobody could hear it.
    stalls : int
    stalled_seconds : float
        How often and how long it waited for data while meant to play.
    frames, dropped_frames : int or None
        Pictures to be shown and pictures left out; None where the browser does not count them.
    """

    rate: Annotated[float, Field(gt=0, le=100, allow_inf_nan=False)] = 1.0
    hidden_seconds: Seconds = 0.0
    silent_seconds: Seconds = 0.0
    stalls: Count = 0
    stalled_seconds: Seconds = 0.0
    frames: Count | None = None
    dropped_frames: Count | None = None


@dataclass(frozen=True, kw_only=True)
class Report(Playback):
    """One numbered report of how a stretch of a video played.

    What a browser sends is checked where it is read, by `read_report`.

    Attributes
    ----------
    batch : int
        Its number within the video, from 0.
    intervals : tuple of (float, float)
        Played parts, each from and to, in seconds from the video's start.
    """

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="forbid")

    batch: Annotated[int, Field(ge=0, lt=MAX_REPORTS, strict=True)]
    intervals: Annotated[tuple[PlayedInterval, ...], Field(max_length=MAX_INTERVALS)]

    @property
    def checksum(self) -> int:
        """The same for a report that is sent again, another for almost any other."""
        return zlib.crc32(repr(self).encode())

    @property
    def played_seconds(self) -> float:
        """Seconds of all its parts together."""
        return total_seconds(self.intervals)


REPORT: Final = TypeAdapter(Report)


def read_report(sent: bytes) -> Report:
    """Return the report that a browser sent as JSON.

    Raises
    ------
    ValidationError
        If it is none, or holds what no browser can have measured.
    """
    return REPORT.validate_json(sent)


@dataclass(frozen=True, kw_only=True)
class Record(Playback):
    """All reports of one video, added up; see `studyapp.database.tables.WatchRecord`."""

    intervals: Sequence[Sequence[float]] = ()
    played_seconds: float = 0.0
    latest: Sequence[Sequence[int]] = ()


NOTHING_PLAYED: Final = Record(rate=0.0)


class Recorded(Protocol):
    """What must be known of a record to judge it."""

    @property
    def intervals(self) -> Sequence[Sequence[float]]:
        """The parts that count as watched, disjoint and in order."""

    @property
    def latest(self) -> Sequence[Sequence[int]]:
        """Numbers and checksums of the latest reports."""


class Played(Protocol):
    """What must be known of a video to judge what was watched of it."""

    @property
    def duration(self) -> float:
        """Its length in seconds."""

    @property
    def sent_at(self) -> datetime | None:
        """When it was first sent; None where it never was."""

    @property
    def watch_record(self) -> Recorded | None:
        """What was reported of it; None where nothing was."""


@dataclass(frozen=True, kw_only=True)
class Watched:
    """What is known of one video of a trial.

    Attributes
    ----------
    intervals : tuple of (float, float)
        Watched parts in seconds, merged and in order.
    missing : float
        Seconds that must still be watched before the questions can be answered.
    next_batch : int
        Number of the next report.
    stored : bool
        Whether the report just sent is among those known; not so where another window has used
        its number.
    """

    intervals: tuple[Interval, ...]
    missing: float
    next_batch: int
    stored: bool = True


def merge_intervals(intervals: Iterable[Sequence[float]]) -> tuple[Interval, ...]:
    """Return the union of `intervals` as disjoint ones in order."""
    union: list[Interval] = []
    for start, end in sorted((start, end) for start, end in intervals):
        if union and start <= union[-1][1]:
            union[-1] = (union[-1][0], max(union[-1][1], end))
        else:
            union.append((start, end))
    return tuple(union)


def total_seconds(intervals: Iterable[Sequence[float]]) -> float:
    """Return the seconds of all `intervals` together, what is in two of them twice."""
    return sum(end - start for start, end in intervals)


def counts_as_watched(played: Playback, *, soundless: bool) -> bool:
    """Tell whether what was `played` like this was watched."""
    return (
        played.rate <= MAX_RATE
        and played.hidden_seconds == 0
        and (played.silent_seconds == 0 or soundless)
    )


def is_stored(record: Recorded, report: Report) -> bool | None:
    """Tell whether `record` holds `report`.

    Returns
    -------
    bool or None
        False where the number is used up by another report; None where it is still free.
    """
    for number, checksum in record.latest:
        if number == report.batch:
            return checksum == report.checksum
    full = len(record.latest) == REMEMBERED_REPORTS
    return False if full and report.batch < record.latest[0][0] else None


def add_report(record: Record, report: Report, *, soundless: bool) -> Record:
    """Return `record` with one more report in it."""
    watched = report.intervals if counts_as_watched(report, soundless=soundless) else ()
    latest = sorted([*record.latest, (report.batch, report.checksum)], key=itemgetter(0))
    return Record(
        intervals=merge_intervals([*record.intervals, *watched]),
        played_seconds=record.played_seconds + report.played_seconds,
        latest=latest[-REMEMBERED_REPORTS:],
        rate=max(record.rate, report.rate),
        hidden_seconds=record.hidden_seconds + report.hidden_seconds,
        silent_seconds=record.silent_seconds + report.silent_seconds,
        stalls=record.stalls + report.stalls,
        stalled_seconds=record.stalled_seconds + report.stalled_seconds,
        frames=_add_counts(record.frames, report.frames),
        dropped_frames=_add_counts(record.dropped_frames, report.dropped_frames),
    )


def _add_counts(so_far: int | None, more: int | None) -> int | None:
    return so_far if more is None else (so_far or 0) + more


def measure_watched(video: Played, coverage: float) -> Watched:
    """Return what has been watched of `video`; nothing where it was never sent.

    Parameters
    ----------
    coverage : float
        Share of the video that must have been watched, in [0, 1].
    """
    record = video.watch_record or NOTHING_PLAYED
    proven = record.intervals if video.sent_at is not None else ()
    intervals = tuple((start, end) for start, end in proven)
    missing = max(0.0, coverage * video.duration - total_seconds(intervals))
    return Watched(
        intervals=intervals,
        missing=0.0 if missing < 1e-3 else missing,
        next_batch=record.latest[-1][0] + 1 if record.latest else 0,
    )


def failed_to_play(video: Video, media_error: str) -> bool:
    """Tell whether anything shows that `video` does not play.

    The server must have sent it, or tried to; and the browser must report an error with it, or
    have reported that it waited long for data.
    """
    stalled = 0.0 if video.watch_record is None else video.watch_record.stalled_seconds
    return video.sent_at is not None and (media_error in MEDIA_ERRORS or stalled >= LONG_STALL)


def missing_seconds(trial: Trial, coverage: float) -> float:
    """Return the seconds that must still be watched of all videos of `trial` together."""
    return sum(measure_watched(video, coverage).missing for video in trial.videos)


def watched_share(videos: Sequence[Played]) -> float:
    """Return the share of all `videos` together that was watched, in [0, 1]; nan of none."""
    total = sum(video.duration for video in videos)
    played = sum(total_seconds(measure_watched(video, 0.0).intervals) for video in videos)
    return min(1.0, played / total) if total else math.nan
