"""Videos of a trial, under names that say nothing, and what was played of them."""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING

from sqlalchemy import JSON, ForeignKey, String, UniqueConstraint, text
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.database.tables.base import Base

if TYPE_CHECKING:
    from studyapp.database.tables.trial import Trial, TrialStimulus


class Video(Base):
    """One player on a trial's page, and what it plays.

    Attributes
    ----------
    number : int
        From 1 in the page's order; 0 plays the reference that is shown apart.
    token : str
        Random; names the video to the browser, and says nothing else.
    duration : float
        Seconds.
    made_from : str
        Digest of what the picture and the sound were made from when the trial was planned.
    sent_at : datetime or None
        When it was first sent, or the browser was first led to the store that sends it.
    unplayable_at : datetime or None
        When the participant said that it does not play.
    """

    __tablename__ = "videos"
    __table_args__ = (UniqueConstraint("trial_id", "number"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    trial_id: Mapped[int] = mapped_column(ForeignKey("trials.id", ondelete="CASCADE"))
    number: Mapped[int]
    token: Mapped[str] = mapped_column(String(64), unique=True)
    duration: Mapped[float]
    made_from: Mapped[str] = mapped_column(String(64), default="", server_default=text("''"))
    sent_at: Mapped[datetime | None]
    unplayable_at: Mapped[datetime | None]

    trial: Mapped[Trial] = relationship(back_populates="videos")
    stimuli: Mapped[list[TrialStimulus]] = relationship(
        back_populates="video", order_by="TrialStimulus.number", cascade="all, delete-orphan"
    )

    watch_record: Mapped[WatchRecord | None] = relationship(
        back_populates="video", cascade="all, delete-orphan"
    )

    @property
    def soundless(self) -> bool:
        """Whether it is meant to be seen without sound."""
        return all(shown.speech is None for shown in self.stimuli)


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
