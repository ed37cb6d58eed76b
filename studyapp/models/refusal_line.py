"""Refusals: requests that were turned away, for whoever asks later what went wrong."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.models.base import Base


class RefusalLine(Base):
    """One request that was refused and changed nothing.

    Attributes
    ----------
    study_session_id : int or None
        Whose page it came from; None where the address belongs to nobody.
    kind : str
        What was tried, as a few words with hyphens, such as ``wrong-trial``.
    detail : str
        What there is to know beside it; never an address or a token.
    """

    __tablename__ = "refusals"

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime]
    study_session_id: Mapped[int | None] = mapped_column(
        ForeignKey("study_sessions.id", ondelete="CASCADE"), index=True
    )
    kind: Mapped[str] = mapped_column(String(40))
    detail: Mapped[str] = mapped_column(String(300))
