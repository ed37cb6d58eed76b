"""Watch evidence: how much of a video has been watched, judged from a browser's reports.

A report is about one stretch of uniform playback. It counts as watched if it was played at normal
speed, in view, and audible if the video has sound; and only if the server has sent the video.
"""

import math
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from operator import itemgetter
from typing import Annotated, ClassVar, Final

from pydantic import AfterValidator, ConfigDict, Field, TypeAdapter

from studyapp.database.tables.trial import Trial, Video

Interval = tuple[float, float]

MAX_RATE: Final = 1.05
"""Highest playback rate that counts as normal speed."""

MAX_REPORTS: Final = 1000
"""Reports accepted for one video: half an hour of playback."""

MAX_INTERVALS: Final = 200
"""Intervals in one report, and in the watched part of a video."""

MEDIA_ERRORS: Final = ("2", "3", "4")
"""Browsers' codes for a video that could not be fetched, decoded or played."""

LONG_STALL: Final = 4.0
"""Seconds without data from which a video counts as stalled; its page says so after five."""

REMEMBERED_REPORTS: Final = 32
"""Reports remembered to recognise repeats; browsers repeat each until it is acknowledged."""


def _runs_forward(interval: Interval) -> Interval:
    start, end = interval
    if start > end:
        raise ValueError("an interval ends before it starts")
    return interval


Seconds = Annotated[float, Field(ge=0, le=86_400, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=0, le=10_000_000, strict=True)]
PlayedInterval = Annotated[tuple[Seconds, Seconds], AfterValidator(_runs_forward)]


@dataclass(frozen=True, kw_only=True)
class Playback:
    """How a stretch of a video played, as reported by a browser.

    Attributes
    ----------
    rate : float
        Highest playback rate; 1 is normal speed.
    hidden_seconds, silent_seconds : float
        How long it played out of view, and inaudibly.
    stalls : int
    stalled_seconds : float
        How often and how long it waited for data.
    frames, dropped_frames : int or None
        Frames to be shown, and frames dropped; None if the browser does not count them.
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
    """One numbered report about a stretch of a video; validated by `read_report`.

    Attributes
    ----------
    batch : int
        Its number within the video, from 0.
    intervals : tuple of (float, float)
        Start and end of each played part, in seconds.
    """

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="forbid")

    batch: Annotated[int, Field(ge=0, lt=MAX_REPORTS, strict=True)]
    intervals: Annotated[tuple[PlayedInterval, ...], Field(max_length=MAX_INTERVALS)]

    @property
    def checksum(self) -> int:
        """A checksum that recognises a repeated report."""
        return zlib.crc32(repr(self).encode())

    @property
    def played_seconds(self) -> float:
        """Seconds of all its parts together."""
        return total_seconds(self.intervals)


REPORT: Final = TypeAdapter(Report)


def read_report(sent: bytes) -> Report:
    """Return the report that a browser sent as JSON, or raise `ValidationError`."""
    return REPORT.validate_json(sent)


@dataclass(frozen=True, kw_only=True)
class Record(Playback):
    """The sum of all reports about one video; see `studyapp.database.tables.trial.WatchRecord`."""

    intervals: Sequence[Sequence[float]] = ()
    played_seconds: float = 0.0
    latest: Sequence[Sequence[int]] = ()


NOTHING_PLAYED: Final = Record(rate=0.0)


@dataclass(frozen=True, kw_only=True)
class PlayedVideo:
    """A video with its watch record, in plain columns.

    Attributes
    ----------
    sent_at : datetime or None
        When it was first sent.
    soundless : bool
        Whether it has no sound.
    watch_record : Record or None
        None before the first report.
    """

    id: int
    token: str
    duration: float
    sent_at: datetime | None
    soundless: bool
    watch_record: Record | None


@dataclass(frozen=True, kw_only=True)
class Watched:
    """How much of one video has been watched.

    Attributes
    ----------
    intervals : tuple of (float, float)
        Watched parts in seconds, merged and in order.
    missing : float
        Seconds to be watched before the questions can be answered.
    next_batch : int
        Number of the next report.
    stored : bool
        Whether the report just sent is stored; False if another window has used its number.
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
    """Return the total length of `intervals`; overlaps count twice."""
    return sum(end - start for start, end in intervals)


def counts_as_watched(playback: Playback, *, soundless: bool) -> bool:
    """Tell whether a stretch with this playback was watched."""
    return (
        playback.rate <= MAX_RATE
        and playback.hidden_seconds == 0
        and (playback.silent_seconds == 0 or soundless)
    )


def is_stored(record: Record, report: Report) -> bool | None:
    """Tell whether `record` contains `report`.

    Returns
    -------
    bool or None
        False if another report has used the number; None if the number is free.
    """
    for number, checksum in record.latest:
        if number == report.batch:
            return checksum == report.checksum
    is_full = len(record.latest) == REMEMBERED_REPORTS
    return False if is_full and report.batch < record.latest[0][0] else None


def add_report(record: Record, report: Report, *, soundless: bool) -> Record:
    """Return `record` with one more report."""
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


def _add_counts(total: int | None, count: int | None) -> int | None:
    return total if count is None else (total or 0) + count


def measure_watched(video: Video | PlayedVideo, coverage: float) -> Watched:
    """Return how much of `video` has been watched; nothing if it was never sent.

    Parameters
    ----------
    coverage : float
        Required share of the video, in [0, 1].
    """
    record = video.watch_record or NOTHING_PLAYED
    watched = _watched_parts(video.sent_at, record.intervals)
    missing = max(0.0, coverage * video.duration - total_seconds(watched))
    return Watched(
        intervals=tuple((start, end) for start, end in watched),
        missing=0.0 if missing < 1e-3 else missing,
        next_batch=record.latest[-1][0] + 1 if record.latest else 0,
    )


def failed_to_play(video: Video, media_error: str) -> bool:
    """Tell whether there is evidence that `video` does not play.

    The server must have sent it, and the browser must report an error or a long wait for data.
    """
    stalled = 0.0 if video.watch_record is None else video.watch_record.stalled_seconds
    return video.sent_at is not None and (media_error in MEDIA_ERRORS or stalled >= LONG_STALL)


def missing_seconds(trial: Trial, coverage: float) -> float:
    """Return the seconds of all videos of `trial` that must still be watched."""
    return sum(measure_watched(video, coverage).missing for video in trial.videos)


def watched_seconds(sent_at: datetime | None, intervals: Sequence[Sequence[float]] | None) -> float:
    """Return the seconds of a video that count as watched; none if it was never sent."""
    return total_seconds(_watched_parts(sent_at, intervals))


def _watched_parts(
    sent_at: datetime | None, intervals: Sequence[Sequence[float]] | None
) -> Sequence[Sequence[float]]:
    return () if sent_at is None or intervals is None else intervals


def watched_share(
    videos: Iterable[tuple[float, datetime | None, Sequence[Sequence[float]] | None]],
) -> float:
    """Return the watched share of all `videos` together, in [0, 1]; nan for no videos.

    Parameters
    ----------
    videos : iterable of (float, datetime or None, sequence of (float, float) or None)
        Duration of each, when it was first sent, and its watched parts.
    """
    total = watched = 0.0
    for duration, sent_at, intervals in videos:
        total += duration
        watched += watched_seconds(sent_at, intervals)
    return min(1.0, watched / total) if total else math.nan
