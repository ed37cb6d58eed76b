"""Trials: what is shown to a participant, in which order."""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING

from sqlalchemy import CheckConstraint, ForeignKey, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.models.base import Base
from studyapp.models.study_session import StudySession

if TYPE_CHECKING:
    from studyapp.models.response import Response
    from studyapp.models.trial_stimulus import TrialStimulus
    from studyapp.models.video import Video


class Trial(Base):
    """One presentation of one or more stimuli to one participant.

    Attributes
    ----------
    token : str
        Random; names the trial to the browser, and says nothing else.
    position : int
        Place within the study session, from 1.
    kind : str
        ``practice``, ``main``, ``repeat``, ``catch`` or ``attention``.
    part : str
        The set, block or task it belongs to; empty where the study has no parts.
    segment, emotion, speaker : str
        The speech it is about.
    expected : int or None
        Of a catch trial: the number of the stimulus that is plainly better.
    instructed : int or None
        Of an attention check: the value that the page asks to choose.
    repeats : int or None
        Position of the practice trial that a repeat shows again.
    shown_at, answered_at, unplayable_at : datetime
        When the page was first shown, when the answers were stored, and when the participant
        said instead that a video does not play.
    seconds : float or None
        From the first showing to the answer.
    """

    __tablename__ = "trials"
    __table_args__ = (
        UniqueConstraint("study_session_id", "position"),
        CheckConstraint(
            "kind IN ('practice', 'main', 'repeat', 'catch', 'attention')", name="kind"
        ),
        CheckConstraint("(kind = 'catch') = (expected IS NOT NULL)", name="expected"),
        CheckConstraint("(kind = 'attention') = (instructed IS NOT NULL)", name="instructed"),
        CheckConstraint("answered_at IS NULL OR unplayable_at IS NULL", name="one_outcome"),
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    study_session_id: Mapped[int] = mapped_column(
        ForeignKey("study_sessions.id", ondelete="CASCADE")
    )
    token: Mapped[str] = mapped_column(String(64), unique=True)
    position: Mapped[int]
    kind: Mapped[str] = mapped_column(String(10))
    part: Mapped[str] = mapped_column(String(100), default="")
    segment: Mapped[str] = mapped_column(String(100))
    emotion: Mapped[str] = mapped_column(String(100))
    speaker: Mapped[str] = mapped_column(String(200))
    expected: Mapped[int | None]
    instructed: Mapped[int | None]
    repeats: Mapped[int | None]
    shown_at: Mapped[datetime | None]
    answered_at: Mapped[datetime | None]
    unplayable_at: Mapped[datetime | None]
    seconds: Mapped[float | None]

    study_session: Mapped[StudySession] = relationship(back_populates="trials")
    videos: Mapped[list[Video]] = relationship(
        back_populates="trial", order_by="Video.number", cascade="all, delete-orphan"
    )
    stimuli: Mapped[list[TrialStimulus]] = relationship(
        back_populates="trial", order_by="TrialStimulus.number", cascade="all, delete-orphan"
    )
    responses: Mapped[list[Response]] = relationship(
        back_populates="trial", cascade="all, delete-orphan", foreign_keys="Response.trial_id"
    )

    @property
    def settled(self) -> bool:
        """Whether the participant is done with it."""
        return self.answered_at is not None or self.unplayable_at is not None

    @property
    def conditions(self) -> tuple[str, ...]:
        """The conditions judged, number 1 first; the reference is not."""
        return tuple(shown.condition for shown in self.stimuli if shown.number > 0)
