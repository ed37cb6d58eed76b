"""Form answers: what participants say about themselves."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import ForeignKey, String, Text, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.models.base import Base
from studyapp.models.study_session import StudySession


class FormAnswer(Base):
    """One answer to one question about the participant; there can be no second.

    Attributes
    ----------
    stage : str
        ``eligibility``, ``consent``, ``demographics`` or ``closing``.
    value : str
        As it was given; empty where a question that need not be answered was left open.
    """

    __tablename__ = "form_answers"
    __table_args__ = (UniqueConstraint("study_session_id", "question"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    study_session_id: Mapped[int] = mapped_column(
        ForeignKey("study_sessions.id", ondelete="CASCADE")
    )
    stage: Mapped[str] = mapped_column(String(20))
    question: Mapped[str] = mapped_column(String(100))
    value: Mapped[str] = mapped_column(Text)
    answered_at: Mapped[datetime]

    study_session: Mapped[StudySession] = relationship(back_populates="form_answers")
