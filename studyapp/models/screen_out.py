"""Screen-outs: whom the study did not look for, where somebody sent them by name."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import String
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.models.base import Base


class ScreenOut(Base):
    """That one person was screened out, and nothing of what they answered.

    Attributes
    ----------
    participant : str
        The recruiter's name for them, or the hash of their invitation.
    screened_out_at : datetime
    """

    __tablename__ = "screen_outs"

    id: Mapped[int] = mapped_column(primary_key=True)
    participant: Mapped[str] = mapped_column(String(200), unique=True)
    screened_out_at: Mapped[datetime]
