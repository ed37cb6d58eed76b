"""Watch batches: which parts of a video a browser reports as played."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import JSON, ForeignKey, UniqueConstraint, text
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.models.base import Base
from studyapp.models.video import Video


class WatchBatch(Base):
    """One numbered report of played intervals; the same number is never stored twice.

    Attributes
    ----------
    intervals : list of [float, float]
        Played parts of the video, each from and to, in seconds.
    rate : float
        Largest playback rate seen while it played; 1 is as recorded.
    hidden_seconds, silent_seconds : float
        How long it played where nobody could see it, and where nobody could hear it, since the
        report before.
    stalls : int
    stalled_seconds : float
        How often and how long it waited for data while meant to play, since the report before.
    frames, dropped_frames : int or None
        Pictures that the browser had to show and those it left out, from when the page was
        loaded to the report; None where the browser does not count them.
    """

    __tablename__ = "watch_batches"
    __table_args__ = (UniqueConstraint("video_id", "batch"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    video_id: Mapped[int] = mapped_column(ForeignKey("videos.id", ondelete="CASCADE"))
    batch: Mapped[int]
    intervals: Mapped[list[list[float]]] = mapped_column(JSON)
    rate: Mapped[float] = mapped_column(default=1.0, server_default=text("1"))
    hidden_seconds: Mapped[float] = mapped_column(default=0.0, server_default=text("0"))
    silent_seconds: Mapped[float] = mapped_column(default=0.0, server_default=text("0"))
    stalls: Mapped[int] = mapped_column(default=0, server_default=text("0"))
    stalled_seconds: Mapped[float] = mapped_column(default=0.0, server_default=text("0"))
    frames: Mapped[int | None]
    dropped_frames: Mapped[int | None]
    received_at: Mapped[datetime]

    video: Mapped[Video] = relationship(back_populates="watch_batches")
