"""Stimuli of a trial: which video shows what."""

from __future__ import annotations

from sqlalchemy import ForeignKey, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.models.base import Base
from studyapp.models.trial import Trial
from studyapp.models.video import Video


class TrialStimulus(Base):
    """One stimulus that a trial presents.

    Attributes
    ----------
    number : int
        1, 2, … are labelled A, B, … and judged; 0 is the reference that is shown apart.
    condition, segment : str
        Whose motion, and for which segment it was made.
    speech : str or None
        The segment that is heard with it; None for silence.
    """

    __tablename__ = "trial_stimuli"
    __table_args__ = (UniqueConstraint("trial_id", "number"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    trial_id: Mapped[int] = mapped_column(ForeignKey("trials.id", ondelete="CASCADE"))
    video_id: Mapped[int] = mapped_column(ForeignKey("videos.id", ondelete="CASCADE"))
    number: Mapped[int]
    condition: Mapped[str] = mapped_column(String(100))
    segment: Mapped[str] = mapped_column(String(100))
    speech: Mapped[str | None] = mapped_column(String(100))

    trial: Mapped[Trial] = relationship(back_populates="stimuli")
    video: Mapped[Video] = relationship(back_populates="stimuli")
