"""Which videos may be served at this moment, and browsers' reports about playing them.

Both are requested most. A video takes one statement after its first sending; a report takes three,
and reads one row for each video of the page. The rules are those of `studyapp.session.state`, in
SQL; the same tests check both.
"""

from collections.abc import Iterable, Sequence
from dataclasses import fields, replace
from datetime import datetime
from itertools import groupby
from typing import Any, Final, cast

from sqlalchemy import Row, Table, bindparam, func, insert, select, update
from sqlalchemy.orm import Session, aliased

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.study_session import Place, StudySession
from studyapp.database.tables.trial import Trial, TrialStimulus, Video, WatchRecord
from studyapp.session.places import regain_place
from studyapp.session.refusal import TooMuchWatchedError, UnacceptableError
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import find_study_session, find_video, require_current_trial
from studyapp.session.watch_evidence import (
    MAX_INTERVALS,
    NOTHING_PLAYED,
    PlayedVideo,
    Record,
    Report,
    Watched,
    add_report,
    is_stored,
    measure_watched,
    merge_intervals,
    total_seconds,
)
from studyapp.study.design.trial import Content, Stimulus

_Other = aliased(Trial)
_Asked = aliased(Video)

CURRENT_POSITION: Final = (
    select(func.min(_Other.position))
    .where(
        _Other.study_session_id == Trial.study_session_id,
        _Other.answered_at.is_(None),
        _Other.unplayable_at.is_(None),
    )
    .correlate(Trial)
    .scalar_subquery()
)
"""The position of `studyapp.session.state.current_trial`."""

RUNNING: Final = (
    StudySession.started_at.is_not(None),
    StudySession.completed_at.is_(None),
    StudySession.withdrawn_at.is_(None),
    StudySession.outcome.is_(None),
)
"""Study sessions that are ``started`` if they still have a place (see `state_of` in `state`)."""

SHOWN_STIMULI: Final = (
    select(TrialStimulus.condition, TrialStimulus.segment, TrialStimulus.speech, Video.sent_at)
    .join(TrialStimulus.video)
    .join(Video.trial)
    .join(Trial.study_session)
    .join(StudySession.place)
    .where(
        Video.token == bindparam("token"),
        *RUNNING,
        (Trial.position - CURRENT_POSITION).in_((0, 1)),
    )
    .order_by(TrialStimulus.number)
)


MARK_SENT: Final = (
    update(Video)
    .where(Video.token == bindparam("video_token"), Video.sent_at.is_(None))
    .values(sent_at=bindparam("now"))
)


def content_to_send(
    database: Database, video_token: str, clock: Clock, *, sent: bool = True
) -> Content | None:
    """Return the content of a video that may be sent now, None for others; store its first sending.

    Only the current and the next trial of a running study session have videos. A video that was
    never asked for cannot have been watched. Only its first request writes, and none for the
    headers alone (not `sent`).
    """
    with database.looking_up() as connection:
        shown = connection.execute(SHOWN_STIMULI, {"token": video_token}).all()
    if sent and shown and shown[0].sent_at is None:
        with database.writing() as session:
            parameters = {"video_token": video_token, "now": clock.now()}
            session.connection().execute(MARK_SENT, parameters)
    return _content(shown) or None


def _content(rows: Iterable[Row[*tuple[Any, ...]]]) -> Content:
    return tuple(
        Stimulus(condition=row.condition, segment=row.segment, speech=row.speech) for row in rows
    )


_AskedTrial = aliased(Trial)

ALL_VIDEOS: Final = (
    select(Video.token, TrialStimulus.condition, TrialStimulus.segment, TrialStimulus.speech)
    .join(TrialStimulus.video)
    .join(Video.trial)
    .where(
        Trial.study_session_id
        == select(_AskedTrial.study_session_id)
        .join(_Asked, _Asked.trial_id == _AskedTrial.id)
        .where(_Asked.token == bindparam("token"))
        .scalar_subquery()
    )
    .order_by(Trial.position, Video.number, TrialStimulus.number)
)


def earlier_contents(database: Database, video_token: str) -> list[Content]:
    """Return the contents of all videos before this one in its study session."""
    with database.looking_up() as connection:
        rows = connection.execute(ALL_VIDEOS, {"token": video_token}).all()
    contents: list[Content] = []
    for token, stimuli in groupby(rows, key=lambda row: row.token):
        if token == video_token:
            break
        contents.append(_content(stimuli))
    return contents


_SESSIONS: Final = cast(Table, StudySession.__table__)
_RECORDS: Final = cast(Table, WatchRecord.__table__)
_RECORDED: Final = tuple(field.name for field in fields(Record))

MARK_ACTIVE: Final = (
    update(_SESSIONS)
    .where(_SESSIONS.c.token == bindparam("session_token"), *RUNNING)
    .values(last_active_at=bindparam("now"))
    .returning(_SESSIONS.c.id)
)
PLAYING_QUERY: Final = (
    select(
        Video.id,
        Video.token,
        Video.duration,
        Video.sent_at,
        ~select(TrialStimulus.id)
        .where(TrialStimulus.video_id == Video.id, TrialStimulus.speech.is_not(None))
        .exists(),
        Trial.shown_at,
        WatchRecord.id,
        *(_RECORDS.c[name] for name in _RECORDED),
    )
    .select_from(_Asked)
    .join(Trial, Trial.id == _Asked.trial_id)
    .join(Place, Place.study_session_id == Trial.study_session_id)
    .join(Video, Video.trial_id == Trial.id)
    .outerjoin(WatchRecord, WatchRecord.video_id == Video.id)
    .where(
        _Asked.token == bindparam("token"),
        Trial.study_session_id == bindparam("id"),
        Trial.position == CURRENT_POSITION,
        Trial.shown_at.is_not(None),
    )
)
INSERT_RECORD: Final = insert(_RECORDS).inline()
UPDATE_RECORD: Final = update(_RECORDS).where(_RECORDS.c.video_id == bindparam("video"))


def load_playing(
    session: Session, token: str, video_token: str, now: datetime
) -> tuple[PlayedVideo, Sequence[PlayedVideo], datetime] | None:
    """Return the reported video if it is one of the current trial's.

    The study session is marked as active, and locked.

    Returns
    -------
    video, others, shown_at : PlayedVideo, sequence of PlayedVideo, datetime
        The video, the other videos on the page, and when the page was first shown. None if they
        are at no trial or at another one, or have lost the place.
    """
    connection = session.connection()
    parameters = {"session_token": token, "now": now}
    study_session_id = connection.execute(MARK_ACTIVE, parameters).scalar()
    if study_session_id is None:
        return None
    videos: dict[str, PlayedVideo] = {}
    shown_at = now
    for number, name, duration, sent_at, soundless, shown_at, record, *values in connection.execute(  # noqa: B007
        PLAYING_QUERY, {"token": video_token, "id": study_session_id}
    ):
        columns = dict(zip(_RECORDED, values, strict=True))
        videos[name] = PlayedVideo(
            id=number,
            token=name,
            duration=duration,
            sent_at=sent_at,
            soundless=bool(soundless),
            watch_record=None if record is None else Record(**columns),
        )
    if video_token not in videos:
        return None
    video = videos.pop(video_token)
    return video, tuple(videos.values()), shown_at


def store_record(session: Session, video: PlayedVideo, record: Record, now: datetime) -> None:
    """Store `record` as the watch record of `video`."""
    values = {**vars(record), "reported_at": now}
    if video.watch_record is None:
        session.connection().execute(INSERT_RECORD, {"video_id": video.id, **values})
    else:
        session.connection().execute(UPDATE_RECORD, {"video": video.id, **values})


TOLERANCE: Final = 1.0
"""Seconds by which a browser's clock may run ahead of the server's."""


def record_watched(
    database: Database,
    served: ServedStudy,
    token: str,
    video_token: str,
    report: Report,
    clock: Clock,
) -> Watched:
    """Store one numbered report and return how much of the video has been watched.

    A number is stored once, so that a browser can safely repeat a report. If another window has
    used the number, `Watched.stored` is False, and the report can be sent as
    `Watched.next_batch`.

    Parameters
    ----------
    video_token : str
        The played video.
    report : Report
        Intervals outside the video are cut off.

    Raises
    ------
    RefusalError
        If the video is not theirs or not in the current trial, or more was played than is possible
        since the trial was shown, as its videos never play at once. If the clock has been set back
        since, the latter is not checked.
    """
    with database.writing() as session:
        now = clock.now()
        playing = load_playing(session, token, video_token, now)
        if playing is None:
            _restore_place(session, served, token, video_token)
            playing = load_playing(session, token, video_token, now)
        if playing is None:
            raise RuntimeError("SQL and Python disagree about the current trial")
        (video, others, shown_at), coverage = playing, served.study.watching.coverage
        report = _clip_report(video, report)
        record = video.watch_record or NOTHING_PLAYED
        stored = is_stored(record, report)
        if stored is not None:
            return replace(measure_watched(video, coverage), stored=stored)
        record = add_report(record, report, soundless=video.soundless)
        watched = measure_watched(replace(video, watch_record=record), coverage)
        passed = clock.seconds_since(shown_at)
        if passed is not None and _claimed_seconds(report, record, others) > passed + TOLERANCE:
            raise TooMuchWatchedError(
                "More of the video was reported as played than there was time for.",
                "Please play it again.",
            )
        if len(record.intervals) > MAX_INTERVALS:
            raise UnacceptableError(
                "The video was played in too many small parts.", "Please play it from its start."
            )
        store_record(session, video, record, now)
        return watched


def _restore_place(session: Session, served: ServedStudy, token: str, video_token: str) -> None:
    """Give a lost place back, and refuse everybody who is not at the video's trial."""
    study_session = find_study_session(session, token)
    trial = find_video(session, study_session, video_token).trial
    regain_place(session, served, study_session)
    require_current_trial(study_session, trial)


def _clip_report(video: PlayedVideo, report: Report) -> Report:
    """Return `report` without intervals outside the video."""
    intervals = tuple(
        (max(0.0, start), min(video.duration, end))
        for start, end in report.intervals
        if start < video.duration and end > max(0.0, start)
    )
    return replace(report, intervals=intervals)


def _claimed_seconds(report: Report, record: Record, others: Sequence[PlayedVideo]) -> float:
    """Return the seconds that must have passed if `report` is true; `record` includes it.

    Videos that have not been sent are included: their reports count as soon as they are.
    """
    records = [record, *(other.watch_record or NOTHING_PLAYED for other in others)]
    return max(
        report.hidden_seconds,
        report.silent_seconds,
        report.stalled_seconds,
        total_seconds(merge_intervals(report.intervals)) / max(1.0, report.rate),
        sum(total_seconds(merge_intervals(each.intervals)) for each in records),
    )
