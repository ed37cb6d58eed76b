"""What is playing now: the videos of the present trial, and what was reported of them.

Reports of what was played are what is sent most. Each takes three statements, which load no more
than they need; `studyapp.services.sitting` says in Python what is said in SQL here, and the same
tests hold both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from datetime import datetime
from typing import Final, cast

from sqlalchemy import Table, bindparam, insert, select, update
from sqlalchemy.orm import Session, aliased

from studyapp.models import Place, StudySession, Trial, TrialStimulus, Video, WatchBatch
from studyapp.services.showing import PRESENT_POSITION, RUNNING
from studyapp.services.watch_evidence import Report

_Asked = aliased(Video)
_SESSIONS: Final = cast(Table, StudySession.__table__)
_REPORT: Final = tuple(field.name for field in fields(Report))

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
        ~select(TrialStimulus.id)
        .where(TrialStimulus.video_id == Video.id, TrialStimulus.speech.is_not(None))
        .exists(),
        Trial.shown_at,
        *(getattr(WatchBatch, name) for name in _REPORT),
    )
    .select_from(_Asked)
    .join(Trial, Trial.id == _Asked.trial_id)
    .join(Place, Place.study_session_id == Trial.study_session_id)
    .join(Video, Video.trial_id == Trial.id)
    .outerjoin(WatchBatch, WatchBatch.video_id == Video.id)
    .where(
        _Asked.token == bindparam("token"),
        Trial.study_session_id == bindparam("id"),
        Trial.position == PRESENT_POSITION,
        Trial.shown_at.is_not(None),
    )
    .order_by(Video.number, WatchBatch.batch)
)
ADDED: Final = insert(cast(Table, WatchBatch.__table__)).inline()


@dataclass(frozen=True, kw_only=True)
class PlayedVideo:
    """A video and what was reported of it.

    Attributes
    ----------
    soundless : bool
        Whether it is meant to be seen without sound.
    watch_batches : sequence of Report
        In the order of their numbers.
    """

    id: int
    token: str
    duration: float
    soundless: bool
    watch_batches: Sequence[Report]


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
    rows = connection.execute(PLAYING, {"token": video_token, "id": own}).all()
    videos: dict[str, PlayedVideo] = {}
    shown_at = now
    for number, name, duration, soundless, shown_at, *report in rows:  # noqa: B007
        video = videos.setdefault(
            name,
            PlayedVideo(
                id=number,
                token=name,
                duration=duration,
                soundless=bool(soundless),
                watch_batches=[],
            ),
        )
        if report[0] is not None:
            cast(list[Report], video.watch_batches).append(
                Report(**dict(zip(_REPORT, report, strict=True)))
            )
    if video_token not in videos:
        return None
    video = videos.pop(video_token)
    return Playing(video=video, others=tuple(videos.values()), shown_at=shown_at)


def add_report(session: Session, video: PlayedVideo, report: Report, now: datetime) -> None:
    """Store one more report of `video`."""
    session.connection().execute(
        ADDED, {"video_id": video.id, "received_at": now, **asdict(report)}
    )
