"""Watch evidence: which parts of a video were really played, judged by the server."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from studyapp.clock import Clock
from studyapp.models import Trial, Video, WatchBatch
from studyapp.services.database import Database
from studyapp.services.places import regain_place
from studyapp.services.refusal import UnacceptableError
from studyapp.services.served_study import ServedStudy
from studyapp.services.sitting import find, require_present, video_of

Interval = tuple[float, float]

TOLERANCE: Final = 1.0
"""Seconds by which a browser's clock may be ahead of what has passed on the server."""


@dataclass(frozen=True, kw_only=True)
class Watched:
    """What is known of one video of a trial.

    Attributes
    ----------
    intervals : tuple of (float, float)
        Played parts in seconds, merged and in order.
    missing : float
        Seconds that must still be played before the questions can be answered.
    next_batch : int
        Number of the next report.
    """

    intervals: tuple[Interval, ...]
    missing: float
    next_batch: int


def merged(intervals: Iterable[Interval]) -> tuple[Interval, ...]:
    """Return the union of `intervals` as disjoint ones in order."""
    union: list[Interval] = []
    for start, end in sorted(intervals):
        if union and start <= union[-1][1]:
            union[-1] = (union[-1][0], max(union[-1][1], end))
        else:
            union.append((start, end))
    return tuple(union)


def length(intervals: Sequence[Interval]) -> float:
    """Return the seconds that disjoint `intervals` cover together."""
    return sum(end - start for start, end in intervals)


def watched_so_far(video: Video, coverage: float) -> Watched:
    """Return what has been played of `video`.

    Parameters
    ----------
    video : Video
        Loaded with its watch batches.
    coverage : float
        Share of the video that must have been played, in [0, 1].
    """
    reported = [(start, end) for batch in video.watch_batches for start, end in batch.intervals]
    union = merged(reported)
    missing = max(0.0, coverage * video.duration - length(union))
    return Watched(
        intervals=union,
        missing=0.0 if missing < 1e-3 else missing,
        next_batch=max((batch.batch for batch in video.watch_batches), default=-1) + 1,
    )


def missing_seconds(trial: Trial, coverage: float) -> float:
    """Return the seconds that must still be played of all videos of `trial` together."""
    return sum(watched_so_far(video, coverage).missing for video in trial.videos)


def watched_share(trial: Trial) -> float:
    """Return the share of all videos of `trial` together that was played, in [0, 1]."""
    played = sum(length(watched_so_far(video, 0.0).intervals) for video in trial.videos)
    return min(1.0, played / sum(video.duration for video in trial.videos))


def record_watched(
    database: Database,
    served: ServedStudy,
    token: str,
    video_token: str,
    *,
    batch: int,
    intervals: Sequence[Interval],
    clock: Clock,
) -> Watched:
    """Store one numbered report of played intervals and return what is known of the video now.

    A number is stored once, so that a report may be sent again when its fate is unknown. Where
    another window has used the number, the answer lacks what was reported; it can be sent again
    under `Watched.next_batch`.

    Parameters
    ----------
    video_token : str
        The video that was played.
    batch : int
        Number of the report within the video, from 0.
    intervals : sequence of (float, float)
        Played parts in seconds from the video's start; what lies outside the video is cut off.

    Raises
    ------
    RefusalError
        If the video is not theirs or not of the present trial, or more of the trial's videos is
        claimed to be played than time has passed since they were first shown: never do two of
        them play at once.
    """
    with database.writing() as session:
        study_session = find(session, token)
        video = video_of(session, study_session, video_token)
        regain_place(session, served, study_session)
        shown_at = require_present(study_session, video.trial)
        coverage = served.study.watching.coverage
        inside = [
            (max(0.0, start), min(video.duration, end))
            for start, end in intervals
            if start < video.duration and end > max(0.0, start)
        ]
        before = watched_so_far(video, coverage)
        if batch in {known.batch for known in video.watch_batches}:
            return before
        others = sum(
            length(watched_so_far(other, coverage).intervals)
            for other in video.trial.videos
            if other is not video
        )
        played = others + length(merged([*before.intervals, *inside]))
        if played > clock.seconds_since(shown_at) + TOLERANCE:
            raise UnacceptableError(
                "More of the video was reported as played than time has passed.",
                "Please play it again.",
            )
        now = clock.now()
        study_session.last_active_at = now
        video.watch_batches.append(
            WatchBatch(batch=batch, intervals=[list(pair) for pair in inside], received_at=now)
        )
        session.flush()
        return watched_so_far(video, coverage)
