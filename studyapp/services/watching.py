"""Storing a browser's reports of what was played."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Final

from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.services.database import Database
from studyapp.services.places import regain_place
from studyapp.services.playing import PlayedVideo, Playing, add_report, load_playing
from studyapp.services.refusal import TooMuchWatchedError
from studyapp.services.served_study import ServedStudy
from studyapp.services.sitting import find, require_present, video_of
from studyapp.services.watch_evidence import (
    AS_RECORDED,
    Interval,
    Playback,
    Report,
    Watched,
    counts,
    length,
    merged,
    watched_so_far,
)

TOLERANCE: Final = 1.0
"""Seconds by which a browser's clock may be ahead of what has passed on the server."""


def record_watched(
    database: Database,
    served: ServedStudy,
    token: str,
    video_token: str,
    *,
    batch: int,
    intervals: Sequence[Interval],
    clock: Clock,
    playback: Playback = AS_RECORDED,
) -> Watched:
    """Store one numbered report of played intervals and return what is known of the video now.

    A number is stored once, so that a report may be sent again when its fate is unknown. Where
    another window has used the number for another report, `Watched.stored` says so; it can be
    sent again under `Watched.next_batch`.

    Parameters
    ----------
    video_token : str
        The video that was played.
    batch : int
        Number of the report within the video, from 0.
    intervals : sequence of (float, float)
        Played parts in seconds from the video's start; what lies outside the video is cut off.
    playback : Playback
        How they were played.

    Raises
    ------
    RefusalError
        If the video is not theirs or not of the present trial, or more of the trial's videos is
        claimed to be played than time has passed since they were first shown: never do two of
        them play at once.
    """
    with database.writing() as session:
        now = clock.now()
        playing = load_playing(session, token, video_token, now)
        if playing is None:
            _bring_back(session, served, token, video_token)
            playing = load_playing(session, token, video_token, now)
        if playing is None:
            raise RuntimeError("what is playing in SQL is not what is playing in Python")
        video, coverage = playing.video, served.study.watching.coverage
        report = _report(video, batch, intervals, playback)
        before = watched_so_far(video, coverage)
        for known in video.watch_batches:
            if known.batch == batch:
                return replace(before, stored=known == report)
        possible = clock.seconds_since(playing.shown_at) + TOLERANCE
        if _claimed(playing, report, before, coverage) > possible:
            raise TooMuchWatchedError(
                "More of the video was reported as played than time has passed.",
                "Please play it again.",
            )
        add_report(session, video, report, now)
        return watched_so_far(
            replace(video, watch_batches=(*video.watch_batches, report)), coverage
        )


def _bring_back(session: Session, served: ServedStudy, token: str, video_token: str) -> None:
    """Give a place back that was lost to a pause; refuse everybody else who is not at the video."""
    study_session = find(session, token)
    video = video_of(session, study_session, video_token)
    regain_place(session, served, study_session)
    require_present(study_session, video.trial)


def _report(
    video: PlayedVideo, batch: int, intervals: Sequence[Interval], playback: Playback
) -> Report:
    inside = [
        [max(0.0, start), min(video.duration, end)]
        for start, end in intervals
        if start < video.duration and end > max(0.0, start)
    ]
    return Report(batch=batch, intervals=inside, **asdict(playback))


def _claimed(playing: Playing, report: Report, before: Watched, coverage: float) -> float:
    """Return the seconds that must have passed if `report` is true."""
    intervals = [(start, end) for start, end in report.intervals]
    measured = max(report.hidden_seconds, report.silent_seconds, report.stalled_seconds)
    if not counts(report, playing.video):
        return max(measured, length(merged(intervals)) / max(1.0, report.rate))
    others = sum(length(watched_so_far(other, coverage).intervals) for other in playing.others)
    return max(measured, others + length(merged([*before.intervals, *intervals])))
