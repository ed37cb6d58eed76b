"""Researchers' accounts, links and logins."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import JSON, CheckConstraint, ForeignKey, String, Text, text
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.database.tables.base import Base


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


class ResearcherLink(Base):
    """One link that has not been used; using it removes the row.

    Attributes
    ----------
    token_hash : str
        SHA-256 of what stands in the link.
    purpose : str
        ``first_owner`` and ``invitation`` make an account, ``new_password`` changes one.
    role : str or None
        Of the account to be made.
    researcher_id : int or None
        Whose password is to be chosen.
    made_at, expires_at : datetime
    made_by : str
        The researcher who made it; empty where it was the command line.
    """

    __tablename__ = "researcher_links"
    __table_args__ = (
        CheckConstraint("purpose IN ('first_owner', 'invitation', 'new_password')", name="purpose"),
        CheckConstraint("(purpose = 'new_password') = (researcher_id IS NOT NULL)", name="whose"),
        CheckConstraint("(role IS NULL) = (researcher_id IS NOT NULL)", name="role"),
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    token_hash: Mapped[str] = mapped_column(String(64), unique=True)
    purpose: Mapped[str] = mapped_column(String(20))
    role: Mapped[str | None] = mapped_column(String(10))
    researcher_id: Mapped[int | None] = mapped_column(
        ForeignKey("researchers.id", ondelete="CASCADE"), index=True
    )
    made_at: Mapped[datetime]
    expires_at: Mapped[datetime]
    made_by: Mapped[str] = mapped_column(String(100))


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


class LoginAttempt(Base):
    """One attempt; it is removed after a while, and where the right password was given.

    Attributes
    ----------
    name_hash : str
        SHA-256 of the name as it is compared, whether there is such a researcher or not.
    address : str
        The network address it came from.
    """

    __tablename__ = "login_attempts"

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime] = mapped_column(index=True)
    name_hash: Mapped[str] = mapped_column(String(64), index=True)
    address: Mapped[str] = mapped_column(String(64), index=True)
