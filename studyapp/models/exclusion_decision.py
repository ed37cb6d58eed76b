"""Exclusion decisions: whom researchers leave out of the analysis, or take in again, and why."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import ForeignKey, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.models.base import Base


class ExclusionDecision(Base):
    """One decision about one study session; the newest one holds, older ones are kept.

    Attributes
    ----------
    study_session_id : int
        Whom it is about.
    excluded : bool
        Whether the participant is left out from then on. Before, it was the opposite: nothing is
        decided that is so already.
    researcher, reason : str
        Who decided it, empty for the command line; and why.
    """

    __tablename__ = "exclusion_decisions"

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime]
    study_session_id: Mapped[int] = mapped_column(
        ForeignKey("study_sessions.id", ondelete="CASCADE"), index=True
    )
    excluded: Mapped[bool]
    researcher: Mapped[str] = mapped_column(String(100))
    reason: Mapped[str] = mapped_column(Text)
