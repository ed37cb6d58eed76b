"""Researchers' accounts and logins, what they did and decided, and what they are shown."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum

from sqlalchemy import JSON, CheckConstraint, ForeignKey, String, Text, UniqueConstraint, text
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
    identity : str or None
        The same random letters in all accounts of one person, at a desk and in its studies.
        Accounts that are older than desks have none. Names never say who somebody is.
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
    identity: Mapped[str | None] = mapped_column(String(43), unique=True, index=True)


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
    DEFINITION_EDITED = "definition_edited"
    JOB_BEGUN = "job_begun"
    JOB_STOPPED = "job_stopped"
    DOWNLOADED = "downloaded"
    MATERIAL_REMOVED = "material_removed"


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
