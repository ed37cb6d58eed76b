"""Figures of the answers so far, and alarms that were sent."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import CheckConstraint, String, Text, UniqueConstraint, text
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.database.tables.base import Base


class InterimFigures(Base):
    """What was last computed of one kind; all of it can be computed again.

    Attributes
    ----------
    what : str
        ``agreement`` or ``results``.
    begun_at : datetime or None
        Since when it is being computed; None while it is not.
    tried_at : datetime or None
        When that last ended, well or not.
    state : str
        What of the database it depends on, as it was when that began; a digest.
    document : str
        The figures as JSON; empty before there are any.
    problem : str
        Why the last attempt gave none; empty where it did.
    """

    __tablename__ = "interim_figures"
    __table_args__ = (CheckConstraint("what IN ('agreement', 'results')", name="what"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    what: Mapped[str] = mapped_column(String(20), unique=True)
    begun_at: Mapped[datetime | None]
    tried_at: Mapped[datetime | None]
    state: Mapped[str] = mapped_column(String(100), default="", server_default=text("''"))
    document: Mapped[str] = mapped_column(Text, default="", server_default=text("''"))
    problem: Mapped[str] = mapped_column(Text, default="", server_default=text("''"))


class Alarm(Base):
    """One alarm; the server process that stores it sends it.

    Attributes
    ----------
    kind : str
        ``full``, ``stalled`` or ``one address``.
    about : str
        What makes it another event than an earlier one of its kind.
    """

    __tablename__ = "alarms"
    __table_args__ = (UniqueConstraint("kind", "about"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    kind: Mapped[str] = mapped_column(String(20))
    about: Mapped[str] = mapped_column(String(100))
    at: Mapped[datetime]
