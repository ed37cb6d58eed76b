"""Logins: browsers in which a researcher is logged in."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import ForeignKey, String, Text, text
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.models.base import Base


class ResearcherLogin(Base):
    """One browser's login; without this row its cookie is worth nothing.

    Attributes
    ----------
    token_hash : str
        SHA-256 of the cookie: who reads the database cannot log in with it.
    began_at, last_active_at : datetime
        When the password was given, and when a page was last asked for by hand.
    unblinded_at, unblinding_reason : datetime or None, str
        When the researcher last asked for results before the end, and why.
    """

    __tablename__ = "researcher_logins"

    id: Mapped[int] = mapped_column(primary_key=True)
    researcher_id: Mapped[int] = mapped_column(
        ForeignKey("researchers.id", ondelete="CASCADE"), index=True
    )
    token_hash: Mapped[str] = mapped_column(String(64), unique=True)
    began_at: Mapped[datetime]
    last_active_at: Mapped[datetime]
    unblinded_at: Mapped[datetime | None]
    unblinding_reason: Mapped[str] = mapped_column(Text, default="", server_default=text("''"))
