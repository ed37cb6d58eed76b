"""Looks: when results were seen, and how far the study was then."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import CheckConstraint, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.models.base import Base


class Look(Base):
    """One look at results; rows are only ever added.

    Attributes
    ----------
    way : str
        ``page`` of researchers, ``report``, or ``export``.
    researcher : str
        Who looked; empty where the command line did.
    reason : str
        In their words; empty where the command line was given none.
    finished, planned : int
        Participants who had finished, and how many were wanted at that time.
    answers : int
        Answers that the results rested on, before anybody was left out.
    """

    __tablename__ = "looks"
    __table_args__ = (
        CheckConstraint("way IN ('page', 'report', 'export')", name="way"),
        CheckConstraint("finished >= 0 AND planned >= 0 AND answers >= 0", name="counts"),
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime]
    way: Mapped[str] = mapped_column(String(10))
    researcher: Mapped[str] = mapped_column(String(100))
    reason: Mapped[str] = mapped_column(Text)
    finished: Mapped[int]
    planned: Mapped[int]
    answers: Mapped[int]
