"""Newcomers of the last hour by network address, so that one address cannot take all places."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import String
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.models.base import Base


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
