"""Who was invited, came, was screened out or refused."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import ForeignKey, String
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.database.tables.base import Base


class Invitation(Base):
    """One link. Who begins by it has a study session whose `visit` is its hash.

    Attributes
    ----------
    token_hash : str
        SHA-256 of what stands in the link.
    made_at : datetime
    """

    __tablename__ = "invitations"

    id: Mapped[int] = mapped_column(primary_key=True)
    token_hash: Mapped[str] = mapped_column(String(64), unique=True)
    made_at: Mapped[datetime]


class Newcomer(Base):
    """That somebody got a place; nothing says who. It is removed after an hour.

    Attributes
    ----------
    address : str
        The network address they came from.
    """

    __tablename__ = "newcomers"

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime] = mapped_column(index=True)
    address: Mapped[str] = mapped_column(String(64), index=True)


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
