"""Storing a browser's reports of what was played."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.session.arrival.places import regain_place
from studyapp.session.refusal import TooMuchWatchedError, UnacceptableError
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import find, require_present, video_of
from studyapp.session.videos.playback import PlayedVideo, load_playing, store_record
from studyapp.session.videos.watch_evidence import (
    AS_RECORDED,
    MOST_INTERVALS,
    NOTHING_PLAYED,
    Interval,
    Playback,
    Record,
    Report,
    Watched,
    add,
    is_stored,
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
        them play at once. Where the clock was set back since, nothing is refused for that.
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
        record = video.watch_record or NOTHING_PLAYED
        stored = is_stored(record, report)
        if stored is not None:
            return replace(watched_so_far(video, coverage), stored=stored)
        record = add(record, report, soundless=video.soundless)
        watched = watched_so_far(replace(video, watch_record=record), coverage)
        passed = clock.seconds_since(playing.shown_at)
        if passed is not None and _claimed(report, record, playing.others) > passed + TOLERANCE:
            raise TooMuchWatchedError(
                "More of the video was reported as played than there was time for.",
                "Please play it again.",
            )
        if len(record.intervals) > MOST_INTERVALS:
            raise UnacceptableError(
                "The video was played in too many small parts.", "Please play it from its start."
            )
        store_record(session, video, record, now)
        return watched


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
    return Report(batch=batch, intervals=inside, **vars(playback))


def _claimed(report: Report, record: Record, others: Sequence[PlayedVideo]) -> float:
    """Return the seconds that must have passed if `report` is true, which makes it `record`.

    Videos that were not sent yet are included: what is reported of them counts once they are.
    """
    records = [record, *(other.watch_record or NOTHING_PLAYED for other in others)]
    return max(
        report.hidden_seconds,
        report.silent_seconds,
        report.stalled_seconds,
        length(merged(report.intervals)) / max(1.0, report.rate),
        sum(length(merged(each.intervals)) for each in records),
    )
