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
    from studyapp.models.watch_batch import WatchBatch


class Trial(Base):
    """One presentation of a pair to one participant.

    Attributes
    ----------
    position : int
        Place within the study session, from 1.
    kind : str
        ``practice``, ``main``, ``repeat`` or ``catch``.
    left_condition, right_condition : str
        What is shown under A and under B.
    expected : str
        The right answer of a catch trial, ``left`` or ``right``; empty otherwise.
    repeats : int or None
        Position of the practice trial that a repeat shows again.
    duration : float
        Length of the video in seconds.
    media_token : str
        Random; names the trial and its video to the browser, and says nothing else.
    shown_at, answered_at, unplayable_at : datetime
        When the page was first shown, when the answers were stored, and when the participant
        said instead that the video does not play.
    seconds : float or None
        From the first showing to the answer.
    """

    __tablename__ = "trials"
    __table_args__ = (
        UniqueConstraint("study_session_id", "position"),
        CheckConstraint("kind IN ('practice', 'main', 'repeat', 'catch')", name="kind"),
        CheckConstraint("(kind = 'catch') = (expected IN ('left', 'right'))", name="expected"),
        CheckConstraint("answered_at IS NULL OR unplayable_at IS NULL", name="one_outcome"),
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    study_session_id: Mapped[int] = mapped_column(
        ForeignKey("study_sessions.id", ondelete="CASCADE")
    )
    position: Mapped[int]
    kind: Mapped[str] = mapped_column(String(10))
    segment: Mapped[str] = mapped_column(String(100))
    emotion: Mapped[str] = mapped_column(String(100))
    speaker: Mapped[str] = mapped_column(String(200))
    left_condition: Mapped[str] = mapped_column(String(100))
    right_condition: Mapped[str] = mapped_column(String(100))
    expected: Mapped[str] = mapped_column(String(5), default="")
    repeats: Mapped[int | None]
    duration: Mapped[float]
    media_token: Mapped[str] = mapped_column(String(64), unique=True)
    shown_at: Mapped[datetime | None]
    answered_at: Mapped[datetime | None]
    unplayable_at: Mapped[datetime | None]
    seconds: Mapped[float | None]

    study_session: Mapped[StudySession] = relationship(back_populates="trials")
    responses: Mapped[list[Response]] = relationship(
        back_populates="trial", cascade="all, delete-orphan"
    )
    watch_batches: Mapped[list[WatchBatch]] = relationship(
        back_populates="trial", order_by="WatchBatch.batch", cascade="all, delete-orphan"
    )

    @property
    def settled(self) -> bool:
        """Whether the participant is done with it."""
        return self.answered_at is not None or self.unplayable_at is not None
