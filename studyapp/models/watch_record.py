"""Watch records: what a browser reported of how a video played, added up."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import JSON, ForeignKey
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.models.base import Base
from studyapp.models.video import Video


class WatchRecord(Base):
    """All reports of one video together; there is none before the first report.

    Attributes
    ----------
    intervals : list of [float, float]
        The parts that count as watched, from and to, in seconds: disjoint and in order.
    played_seconds : float
        Everything that played, replays included, whether it counts or not.
    rate : float
        Largest playback rate seen; 1 is as recorded.
    hidden_seconds, silent_seconds : float
        How long it played where nobody could see it, and where nobody could hear it.
    stalls : int
    stalled_seconds : float
        How often and how long it waited for data while it was meant to play.
    frames, dropped_frames : int or None
        Pictures that the browser had to show, and those it left out; None where it does not
        count them.
    latest : list of [int, int]
        Number and checksum of the latest reports, in order of their numbers: a report that is
        sent again is known by them.
    reported_at : datetime
        When the latest report came.
    """

    __tablename__ = "watch_records"

    id: Mapped[int] = mapped_column(primary_key=True)
    video_id: Mapped[int] = mapped_column(ForeignKey("videos.id", ondelete="CASCADE"), unique=True)
    intervals: Mapped[list[list[float]]] = mapped_column(JSON)
    played_seconds: Mapped[float]
    rate: Mapped[float]
    hidden_seconds: Mapped[float]
    silent_seconds: Mapped[float]
    stalls: Mapped[int]
    stalled_seconds: Mapped[float]
    frames: Mapped[int | None]
    dropped_frames: Mapped[int | None]
    latest: Mapped[list[list[int]]] = mapped_column(JSON)
    reported_at: Mapped[datetime]

    video: Mapped[Video] = relationship(back_populates="watch_record")
