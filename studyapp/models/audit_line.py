"""Audit lines: what was changed while the study ran, and when."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import String, Text
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.models.base import Base


class AuditLine(Base):
    """One change; lines are only ever added."""

    __tablename__ = "audit_lines"

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime]
    event: Mapped[str] = mapped_column(String(100))
    detail: Mapped[str] = mapped_column(Text)
