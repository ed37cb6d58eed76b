"""Alarms: what researchers have been told of the running study, each thing once."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.models.base import Base


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
