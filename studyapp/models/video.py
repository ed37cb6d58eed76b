"""Videos of a trial, under names that say nothing."""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING

from sqlalchemy import ForeignKey, String, UniqueConstraint, text
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.models.base import Base
from studyapp.models.trial import Trial

if TYPE_CHECKING:
    from studyapp.models.trial_stimulus import TrialStimulus
    from studyapp.models.watch_record import WatchRecord


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
