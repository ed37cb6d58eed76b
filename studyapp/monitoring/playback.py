"""How well videos played: stalls, dropped frames, and those that did not play at all."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from sqlalchemy import ColumnElement, and_, case, exists, func, select
from sqlalchemy.orm import Session, aliased

from studyapp.database.tables import TrialStimulus, Video, WatchRecord

NOTICEABLE: Final = 0.05
"""Share of left out pictures that an attentive eye may notice."""


@dataclass(frozen=True, kw_only=True)
class PlayedVideo:
    """How one video played, to all who saw it.

    Attributes
    ----------
    what : str
        What it shows: its segment and conditions, from left to right.
    shown : int
        How often any of it was played, or was said not to play.
    stalled : int
        In how many of these it waited for data.
    stalled_seconds : float
        For how long in all.
    dropped_share : float or None
        Share of the pictures that browsers left out, in [0, 1].
    reason : str
        Why there is no such share; empty where there is one.
    unplayable : int
        How often somebody said that it does not play.
    """

    what: str
    shown: int
    stalled: int
    stalled_seconds: float
    dropped_share: float | None
    reason: str
    unplayable: int

    @property
    def troubled(self) -> bool:
        """Whether anything did not go as it should."""
        some_left_out = self.dropped_share is not None and self.dropped_share >= NOTICEABLE
        return self.stalled > 0 or self.unplayable > 0 or some_left_out


def played_videos(session: Session) -> tuple[PlayedVideo, ...]:
    """Return how each video played that anybody began to watch, the most trouble first."""
    played = [_played(*row) for row in session.connection().execute(_PLAYED).all()]
    return tuple(
        sorted(played, key=lambda each: (-each.unplayable, -each.stalled / each.shown, each.what))
    )


def _played(
    segment: str,
    condition: str,
    beside: str | None,
    shown: int,
    stalled: int,
    stalled_seconds: float,
    frames: int | None,
    dropped: int | None,
    unplayable: int,
) -> PlayedVideo:
    return PlayedVideo(
        what=f"{segment}: {condition}" if beside is None else f"{segment}: {condition} | {beside}",
        shown=shown,
        stalled=stalled,
        stalled_seconds=float(stalled_seconds),
        dropped_share=int(dropped or 0) / int(frames) if frames else None,
        reason="" if frames else "no browser counts them",
        unplayable=unplayable,
    )


# A video shows one stimulus, or two beside each other.
_FIRST, _SECOND, _EARLIER = (aliased(TrialStimulus) for _ in range(3))


def _same_video(one: type[TrialStimulus], other: type[TrialStimulus]) -> ColumnElement[bool]:
    return and_(one.trial_id == other.trial_id, one.video_id == other.video_id)


_PLAYED = (
    select(
        _FIRST.segment,
        _FIRST.condition,
        _SECOND.condition,
        func.count(),
        func.sum(case((WatchRecord.stalls > 0, 1), else_=0)),
        func.coalesce(func.sum(WatchRecord.stalled_seconds), 0.0),
        func.sum(case((WatchRecord.frames > 0, WatchRecord.frames))),
        func.sum(case((WatchRecord.frames > 0, WatchRecord.dropped_frames))),
        func.count(Video.unplayable_at),
    )
    .select_from(Video)
    .outerjoin(WatchRecord, WatchRecord.video_id == Video.id)
    .join(_FIRST, and_(_FIRST.trial_id == Video.trial_id, _FIRST.video_id == Video.id))
    .outerjoin(_SECOND, and_(_same_video(_SECOND, _FIRST), _SECOND.number > _FIRST.number))
    .where(
        WatchRecord.id.is_not(None) | Video.unplayable_at.is_not(None),
        ~exists().where(_same_video(_EARLIER, _FIRST), _EARLIER.number < _FIRST.number),
    )
    .group_by(_FIRST.segment, _FIRST.condition, _SECOND.condition)
)
