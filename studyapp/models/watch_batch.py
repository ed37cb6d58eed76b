"""Watch batches: which parts of a video a browser reports as played."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import JSON, ForeignKey, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.models.base import Base
from studyapp.models.video import Video


class WatchBatch(Base):
    """One numbered report of played intervals; the same number is never stored twice.

    Attributes
    ----------
    intervals : list of [float, float]
        Played parts of the video, each from and to, in seconds.
    """

    __tablename__ = "watch_batches"
    __table_args__ = (UniqueConstraint("video_id", "batch"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    video_id: Mapped[int] = mapped_column(ForeignKey("videos.id", ondelete="CASCADE"))
    batch: Mapped[int]
    intervals: Mapped[list[list[float]]] = mapped_column(JSON)
    received_at: Mapped[datetime]

    video: Mapped[Video] = relationship(back_populates="watch_batches")
