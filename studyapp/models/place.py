"""Places: how many participants each arm takes."""

from __future__ import annotations

from sqlalchemy import ForeignKey, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.models.base import Base
from studyapp.models.study_session import StudySession


class Place(Base):
    """One participant's place in an arm.

    A place names the study session that holds it, so it cannot be held by two; and no study
    session can hold two places.

    Attributes
    ----------
    arm : str
        The arm's name.
    design : str
        Digest of what the arm's participants are asked. A new version of the study that changes
        it opens new places; where it does not, the places that are filled stay filled.
    number : int
        From 0 within the arm; it decides the trials.
    """

    __tablename__ = "places"
    __table_args__ = (UniqueConstraint("arm", "design", "number"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    arm: Mapped[str] = mapped_column(String(202))
    design: Mapped[str] = mapped_column(String(64))
    number: Mapped[int]
    study_session_id: Mapped[int | None] = mapped_column(
        ForeignKey("study_sessions.id", ondelete="SET NULL"), unique=True
    )

    study_session: Mapped[StudySession | None] = relationship(back_populates="place")
