"""What researchers did and what they are shown: changes, looks, exclusions, figures, alarms."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum

from sqlalchemy import CheckConstraint, ForeignKey, String, Text, UniqueConstraint, text
from sqlalchemy.orm import Mapped, mapped_column

from studyapp.database.tables.base import Base


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
        One of `Event`; what people read is made from it (see `studyapp.researchers.audit`).
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


class Look(Base):
    """One look at results; rows are only ever added.

    Attributes
    ----------
    way : str
        ``page`` of researchers, ``report``, or ``export``.
    researcher : str
        Who looked; empty where the command line did.
    reason : str
        In their words; empty where the command line was given none.
    finished, planned : int
        Participants who had finished, and how many were wanted at that time.
    answers : int
        Answers that the results rested on, before anybody was left out.
    """

    __tablename__ = "looks"
    __table_args__ = (
        CheckConstraint("way IN ('page', 'report', 'export')", name="way"),
        CheckConstraint("finished >= 0 AND planned >= 0 AND answers >= 0", name="counts"),
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime]
    way: Mapped[str] = mapped_column(String(10))
    researcher: Mapped[str] = mapped_column(String(100))
    reason: Mapped[str] = mapped_column(Text)
    finished: Mapped[int]
    planned: Mapped[int]
    answers: Mapped[int]


class ExclusionDecision(Base):
    """One decision about one study session; the newest one holds, older ones are kept.

    Attributes
    ----------
    study_session_id : int
        Whom it is about.
    excluded : bool
        Whether the participant is left out from then on. Before, it was the opposite: nothing is
        decided that is so already.
    researcher, reason : str
        Who decided it, empty for the command line; and why.
    """

    __tablename__ = "exclusion_decisions"

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime]
    study_session_id: Mapped[int] = mapped_column(
        ForeignKey("study_sessions.id", ondelete="CASCADE"), index=True
    )
    excluded: Mapped[bool]
    researcher: Mapped[str] = mapped_column(String(100))
    reason: Mapped[str] = mapped_column(Text)


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
