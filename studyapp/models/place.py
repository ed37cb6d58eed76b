"""Places: how many participants each comparison takes."""

from __future__ import annotations

from sqlalchemy import ForeignKey, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.models.base import Base
from studyapp.models.study_session import StudySession


class Place(Base):
    """One participant's place in a comparison.

    A place names the study session that holds it, so it cannot be held by two; and no study
    session can hold two places.

    Attributes
    ----------
    reference, other : str
        The conditions compared.
    number : int
        From 0 within the comparison; it decides the trials.
    """

    __tablename__ = "places"
    __table_args__ = (UniqueConstraint("comparison", "number"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    comparison: Mapped[str] = mapped_column(String(202))
    reference: Mapped[str] = mapped_column(String(100))
    other: Mapped[str] = mapped_column(String(100))
    number: Mapped[int]
    study_session_id: Mapped[int | None] = mapped_column(
        ForeignKey("study_sessions.id", ondelete="SET NULL"), unique=True
    )

    study_session: Mapped[StudySession | None] = relationship(back_populates="place")
