"""Researchers: who may look at the study's pages, and in which role."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import JSON, CheckConstraint, String, text
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.models.base import Base


class Researcher(Base):
    """One researcher's account.

    Attributes
    ----------
    name : str
        As it was chosen; shown to other researchers.
    name_key : str
        The name as it is compared: no two differ in case or in how letters are encoded alone.
    role : str
        ``owner``, ``analyst`` or ``viewer``.
    password_hash : str
        Argon2's, with salt and parameters.
    joined_at : datetime
    disabled_at : datetime or None
        Since when nobody can log in with it; None while it is in use.
    totp_secret : str or None
        What the codes of the second factor are made from; None where there is none.
    totp_step : int
        The time step of the newest code that was used; none is used twice.
    recovery_hashes : list of str
        SHA-256 of the codes that stand in for a lost device, each once.
    """

    __tablename__ = "researchers"
    __table_args__ = (CheckConstraint("role IN ('owner', 'analyst', 'viewer')", name="role"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    name: Mapped[str] = mapped_column(String(100))
    name_key: Mapped[str] = mapped_column(String(200), unique=True)
    role: Mapped[str] = mapped_column(String(10))
    password_hash: Mapped[str] = mapped_column(String(300))
    joined_at: Mapped[datetime]
    disabled_at: Mapped[datetime | None]
    totp_secret: Mapped[str | None] = mapped_column(String(64))
    totp_step: Mapped[int] = mapped_column(default=0, server_default=text("0"))
    recovery_hashes: Mapped[list[str]] = mapped_column(
        JSON, default=list, server_default=text("'[]'")
    )
