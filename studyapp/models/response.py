"""Responses: one answer to one question of one trial."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import (
    JSON,
    CheckConstraint,
    ForeignKey,
    ForeignKeyConstraint,
    Index,
    String,
    UniqueConstraint,
    text,
)
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.models.base import Base
from studyapp.models.trial import Trial

ABOUT_THE_TRIAL = text("stimulus IS NULL")


class Response(Base):
    """One answer to one question of one trial or of one of its stimuli; there can be no second.

    Attributes
    ----------
    stimulus : int or None
        Number of the stimulus it is about; None where it is about the whole trial.
    value : int
        What it means is the question's: a preference from -2, clearly A, to 2, clearly B; a
        label from 1 to 5; a slider from 0 to 100; a rank from 1.
    reasons : list of str
        Names of the reasons ticked beside it; beside each rank of an order, those ticked once for
        all of it.
    """

    __tablename__ = "responses"
    __table_args__ = (
        UniqueConstraint("trial_id", "question", "stimulus"),
        # To a unique constraint, two missing stimuli are two different ones.
        Index(
            "uq_responses_trial_id_question",
            "trial_id",
            "question",
            unique=True,
            sqlite_where=ABOUT_THE_TRIAL,
            postgresql_where=ABOUT_THE_TRIAL,
        ),
        ForeignKeyConstraint(
            ["trial_id", "stimulus"],
            ["trial_stimuli.trial_id", "trial_stimuli.number"],
            name="fk_responses_stimulus",
            ondelete="CASCADE",
        ),
        CheckConstraint("value BETWEEN -2 AND 100", name="value"),
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    trial_id: Mapped[int] = mapped_column(ForeignKey("trials.id", ondelete="CASCADE"))
    question: Mapped[str] = mapped_column(String(100))
    stimulus: Mapped[int | None]
    value: Mapped[int]
    reasons: Mapped[list[str]] = mapped_column(JSON)
    answered_at: Mapped[datetime]

    trial: Mapped[Trial] = relationship(back_populates="responses", foreign_keys=[trial_id])
