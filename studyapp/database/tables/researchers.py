"""Researchers' accounts, logins, actions and decisions, and the figures they see."""

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
        The name that other researchers see.
    name_key : str
        The name for comparisons: the same for all cases and encodings of its letters.
    role : str
        ``owner``, ``analyst`` or ``viewer``.
    password_hash : str
        Argon2's, with salt and parameters.
    joined_at : datetime
    disabled_at : datetime or None
        When access was removed; None while the account is in use.
    totp_secret : str or None
        The secret of the second factor; None without one.
    totp_step : int
        The time step of the last code used, so that no code works twice.
    recovery_hashes : list of str
        SHA-256 of the unused recovery codes.
    identity : str or None
        The same random letters in all accounts of one person, at a desk and in its studies. Names
        prove nothing.
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
    """One unused link; using it removes the row.

    Attributes
    ----------
    token_hash : str
        SHA-256 of the link's token.
    purpose : str
        ``first_owner`` and ``invitation`` create an account, ``new_password`` changes one.
    role : str or None
        Role of the new account.
    researcher_id : int or None
        The researcher who gets a new password.
    made_at, expires_at : datetime
    made_by : str
        The researcher who created it; empty for the command line.
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
    """One browser's login; its cookie is worthless without this row.

    Attributes
    ----------
    token_hash : str
        SHA-256 of the cookie, with which nobody can log in.
    began_at, last_active_at : datetime
        When the password was given, and when a page was last opened by hand.
    unblinded_at, unblinding_reason : datetime or None, str
        When the researcher last asked for interim results, and why.
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
    """One attempt to log in; removed after a while, and after the right password.

    Attributes
    ----------
    name_hash : str
        SHA-256 of the name key, whether or not there is such a researcher.
    address : str
        The network address it came from.
    """

    __tablename__ = "login_attempts"

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime] = mapped_column(index=True)
    name_hash: Mapped[str] = mapped_column(String(64), index=True)
    address: Mapped[str] = mapped_column(String(64), index=True)


class Event(StrEnum):
    """Events of the log; programs look for these names, which never change."""

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
        One of `Event`; `studyapp.researchers.audit` has its label.
    study_session : int or None
        The number of the study session it is about, which may no longer exist.
    detail : str
        Details in words, for people only.
    researcher : str
        The name of the researcher; empty for the server and the command line.
    reason : str
        The researcher's reason; empty if none is required.
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
        Who looked; empty for the command line.
    reason : str
        The researcher's reason; may be empty on the command line.
    finished, planned : int
        Finished participants and all places at that time.
    answers : int
        Answers at that time, before any exclusion.
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
    """One decision about one study session; the newest one counts, older ones are kept.

    Attributes
    ----------
    study_session_id : int
    excluded : bool
        Whether the participant is excluded from then on; always the opposite of before.
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
    """The latest figures of one kind, which can be recomputed at any time.

    Attributes
    ----------
    what : str
        ``agreement`` or ``results``.
    begun_at : datetime or None
        When the running computation began; None if there is none.
    tried_at : datetime or None
        When the last computation ended, successfully or not.
    state : str
        Digest of the data behind the document.
    document : str
        The figures as JSON; empty before the first.
    problem : str
        Why the last attempt failed; empty if it did not.
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
        Distinguishes it from earlier events of its kind.
    """

    __tablename__ = "alarms"
    __table_args__ = (UniqueConstraint("kind", "about"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    kind: Mapped[str] = mapped_column(String(20))
    about: Mapped[str] = mapped_column(String(100))
    at: Mapped[datetime]
