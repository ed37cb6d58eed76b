"""Responses: one answer to one question of one trial."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import CheckConstraint, ForeignKey, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.models.base import Base
from studyapp.models.trial import Trial


class Response(Base):
    """One answer to one question of one trial; there can be no second.

    Attributes
    ----------
    value : int
        From -2, clearly A, to 2, clearly B.
    """

    __tablename__ = "responses"
    __table_args__ = (
        UniqueConstraint("trial_id", "question"),
        CheckConstraint("value BETWEEN -2 AND 2", name="value"),
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    trial_id: Mapped[int] = mapped_column(ForeignKey("trials.id", ondelete="CASCADE"))
    question: Mapped[str] = mapped_column(String(100))
    value: Mapped[int]
    answered_at: Mapped[datetime]

    trial: Mapped[Trial] = relationship(back_populates="responses")
