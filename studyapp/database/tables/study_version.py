"""Versions of a study, and decisions about newcomers."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import JSON, CheckConstraint, String, Text, text
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.database.tables.base import Base


class StudyVersion(Base):
    """One design of the study.

    Attributes
    ----------
    number : int
        From 1.
    design : str
        Digest of the design part of the definition.
    definition : str
        The study file's text when this version was opened.
    operation : dict
        The part of the definition that may change within a version, as it is now.
    opened_at : datetime
        When it was first served.
    in_force : bool
        Whether it is the one that was served last.
    """

    __tablename__ = "study_versions"

    id: Mapped[int] = mapped_column(primary_key=True)
    number: Mapped[int] = mapped_column(unique=True)
    design: Mapped[str] = mapped_column(String(64), unique=True)
    definition: Mapped[str] = mapped_column(Text)
    operation: Mapped[dict[str, Any]] = mapped_column(JSON)
    opened_at: Mapped[datetime]
    in_force: Mapped[bool] = mapped_column(default=True, server_default=text("true"))


class IntakeChange(Base):
    """One decision of a researcher; the newest one holds, older ones are kept.

    Attributes
    ----------
    state : str
        ``open``, ``paused`` or ``closed``: whether newcomers are let in, as far as the study
        file lets them in.
    more_places : int
        Places of each arm beyond those that the study file asks for.
    researcher, reason : str
        Who decided it, and why.
    """

    __tablename__ = "intake_changes"
    __table_args__ = (
        CheckConstraint("state IN ('open', 'paused', 'closed')", name="state"),
        CheckConstraint("more_places >= 0", name="more_places"),
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime]
    state: Mapped[str] = mapped_column(String(10))
    more_places: Mapped[int]
    researcher: Mapped[str] = mapped_column(String(100))
    reason: Mapped[str] = mapped_column(Text)
