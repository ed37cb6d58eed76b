"""Which videos may be served at this moment."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import datetime
from itertools import groupby
from typing import Any, Final

from sqlalchemy import Row, bindparam, func, select, update
from sqlalchemy.orm import aliased

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import StudySession, Trial, TrialStimulus, Video
from studyapp.study.design.trial import Content, Stimulus

_Other = aliased(Trial)

Shown = Row[str, str, str | None, datetime | None]
"""A stimulus and the time at which its video was first sent."""

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


def content_of(database: Database, video_token: str) -> Content | None:
    """Return the content of a video that may be served now; None for all others.

    Only the current and the next trial of a running study session have videos. Videos are
    requested most, so this is one statement.
    """
    return _content(_find_stimuli(database, video_token)) or None


def content_to_send(database: Database, video_token: str, clock: Clock) -> Content | None:
    """Return `content_of` the video, and store when it was first sent.

    A video that was never sent cannot have been watched. Only its first request writes.
    """
    shown = _find_stimuli(database, video_token)
    if shown and shown[0].sent_at is None:
        with database.writing() as session:
            parameters = {"video_token": video_token, "now": clock.now()}
            session.connection().execute(MARK_SENT, parameters)
    return _content(shown) or None


def _find_stimuli(database: Database, video_token: str) -> Sequence[Shown]:
    with database.looking_up() as connection:
        return connection.execute(SHOWN_STIMULI, {"token": video_token}).all()


def _content(rows: Iterable[Row[*tuple[Any, ...]]]) -> Content:
    return tuple(
        Stimulus(condition=row.condition, segment=row.segment, speech=row.speech) for row in rows
    )


_Asked = aliased(Video)
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
