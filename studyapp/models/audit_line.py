"""Audit lines: what was changed while the study ran, when, by whom and why."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum

from sqlalchemy import String, Text, text
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.models.base import Base


class Event(StrEnum):
    """What a line tells of; programs look for these names, which never change."""

    FORGOTTEN = "participant_forgotten"
    EXCLUDED = "participant_excluded"
    REINSTATED = "participant_reinstated"
    RESTORED = "restored"
    OPERATION_CHANGED = "operation_changed"
    NEWCOMERS_LET_IN = "newcomers_let_in"
    NEWCOMERS_PAUSED = "newcomers_paused"
    NEWCOMERS_CLOSED = "newcomers_closed"
    EXTENDED = "extended"
    LOOKED_AT = "results_looked_at"
    REPORTED = "results_reported"
    EXPORTED = "answers_exported"
    UNBLINDED = "results_unblinded"
    LOGGED_IN = "logged_in"
    PASSWORD_CHANGED = "password_changed"  # noqa: S105
    PASSWORD_OFFERED = "password_offered"  # noqa: S105
    INVITED = "invited"
    LINK_TAKEN_BACK = "link_taken_back"
    JOINED = "joined"
    ROLE_CHANGED = "role_changed"
    SHUT_OUT = "shut_out"
    LET_IN_AGAIN = "let_in_again"
    SECOND_FACTOR_ON = "second_factor_on"
    SECOND_FACTOR_OFF = "second_factor_off"
    SECOND_FACTOR_RESET = "second_factor_reset"
    NEW_VERSION = "new_version"


class AuditLine(Base):
    """One change; lines are only ever added.

    Attributes
    ----------
    event : str
        One of `Event`; what people read is made from it (see `studyapp.services.audit`).
    study_session : int or None
        The number of the study session that it is about, which may be gone.
    detail : str
        What there is to know beside it, in words; no program looks for anything in it.
    researcher : str
        The name of who did it; empty where it was the server or the command line.
    reason : str
        In their words; empty where none is asked for.
    """

    __tablename__ = "audit_lines"

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime]
    event: Mapped[str] = mapped_column(String(40))
    study_session: Mapped[int | None]
    detail: Mapped[str] = mapped_column(Text)
    researcher: Mapped[str] = mapped_column(String(100), default="", server_default=text("''"))
    reason: Mapped[str] = mapped_column(Text, default="", server_default=text("''"))
