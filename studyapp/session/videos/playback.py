"""What is playing now: the videos of the present trial, and what was reported of them.

Reports of what was played are what is sent most. Each takes three statements, and reads one row
for each video of the page, however many reports came before. `studyapp.session.state` says in
Python what is said in SQL here, and the same tests hold both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from datetime import datetime
from typing import Final, cast

from sqlalchemy import Table, bindparam, insert, select, update
from sqlalchemy.orm import Session, aliased

from studyapp.database.tables import Place, StudySession, Trial, TrialStimulus, Video, WatchRecord
from studyapp.session.videos.video_access import PRESENT_POSITION, RUNNING
from studyapp.session.videos.watch_evidence import Record

_Asked = aliased(Video)
_SESSIONS: Final = cast(Table, StudySession.__table__)
_RECORDS: Final = cast(Table, WatchRecord.__table__)
_RECORDED: Final = tuple(field.name for field in fields(Record))

ACTIVE: Final = (
    update(_SESSIONS)
    .where(_SESSIONS.c.token == bindparam("theirs"), *RUNNING)
    .values(last_active_at=bindparam("now"))
    .returning(_SESSIONS.c.id)
)
PLAYING: Final = (
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
        Trial.position == PRESENT_POSITION,
        Trial.shown_at.is_not(None),
    )
)
FIRST: Final = insert(_RECORDS).inline()
CHANGED: Final = update(_RECORDS).where(_RECORDS.c.video_id == bindparam("video"))


@dataclass(frozen=True, kw_only=True)
class PlayedVideo:
    """A video and what was reported of it.

    Attributes
    ----------
    sent_at : datetime or None
        When it was first sent.
    soundless : bool
        Whether it is meant to be seen without sound.
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
class Playing:
    """The present trial of a study session.

    Attributes
    ----------
    video : PlayedVideo
        The one that was asked about.
    others : sequence of PlayedVideo
        The others on its page.
    shown_at : datetime
        When the page was first shown.
    """

    video: PlayedVideo
    others: Sequence[PlayedVideo]
    shown_at: datetime


def load_playing(session: Session, token: str, video_token: str, now: datetime) -> Playing | None:
    """Return what is playing, if `video_token` is of the trial that the study session stands at.

    The study session is noted as active, and kept from other writers until stored.

    Returns
    -------
    Playing or None
        None where they are at no trial, at another one, or have no place any more.
    """
    connection = session.connection()
    own = connection.execute(ACTIVE, {"theirs": token, "now": now}).scalar()
    if own is None:
        return None
    videos: dict[str, PlayedVideo] = {}
    shown_at = now
    for number, name, duration, sent_at, soundless, shown_at, record, *values in connection.execute(  # noqa: B007
        PLAYING, {"token": video_token, "id": own}
    ):
        known = None if record is None else Record(**dict(zip(_RECORDED, values, strict=True)))
        videos[name] = PlayedVideo(
            id=number,
            token=name,
            duration=duration,
            sent_at=sent_at,
            soundless=bool(soundless),
            watch_record=known,
        )
    if video_token not in videos:
        return None
    video = videos.pop(video_token)
    return Playing(video=video, others=tuple(videos.values()), shown_at=shown_at)


def store_record(session: Session, video: PlayedVideo, record: Record, now: datetime) -> None:
    """Store `record` in place of what is known of `video`."""
    values = {**vars(record), "reported_at": now}
    if video.watch_record is None:
        session.connection().execute(FIRST, {"video_id": video.id, **values})
    else:
        session.connection().execute(CHANGED, {"video": video.id, **values})
