"""Versions of a study, its intake, places, study sessions and arrivals."""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING, Any

from sqlalchemy import JSON, CheckConstraint, ForeignKey, String, Text, UniqueConstraint, text
from sqlalchemy.orm import Mapped, mapped_column, relationship

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
        The current values of keys that may change within a version.
    opened_at : datetime
        When it was first served.
    in_force : bool
        Whether it was served last.
    screened_by_eligibility, screened_by_consent, screened_by_comprehension : int
        How many were screened out by their answers at these stages; nothing says who.
    """

    __tablename__ = "study_versions"

    id: Mapped[int] = mapped_column(primary_key=True)
    number: Mapped[int] = mapped_column(unique=True)
    design: Mapped[str] = mapped_column(String(64), unique=True)
    definition: Mapped[str] = mapped_column(Text)
    operation: Mapped[dict[str, Any]] = mapped_column(JSON)
    opened_at: Mapped[datetime]
    in_force: Mapped[bool] = mapped_column(default=True, server_default=text("true"))
    screened_by_eligibility: Mapped[int] = mapped_column(default=0, server_default=text("0"))
    screened_by_consent: Mapped[int] = mapped_column(default=0, server_default=text("0"))
    screened_by_comprehension: Mapped[int] = mapped_column(default=0, server_default=text("0"))


class IntakeChange(Base):
    """One decision of a researcher; the newest one counts, older ones are kept.

    Attributes
    ----------
    state : str
        ``open``, ``paused`` or ``closed``: whether newcomers are admitted, if the study file
        admits them.
    more_places : int
        Places of each arm beyond those of the study file.
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


if TYPE_CHECKING:
    from studyapp.database.tables.trial import Trial


class StudySession(Base):
    """One participant's session.

    Attributes
    ----------
    token : str
        Part of the participant's addresses; whoever knows it is the participant.
    visit : str or None
        Drawn with the consent page, so that repeated requests create one study session; or the
        hash of the invitation.
    recruiter_participant, recruiter_study, recruiter_session : str
        The recruiter's names (Prolific: ``PROLIFIC_PID``, ``STUDY_ID``, ``SESSION_ID``; MTurk:
        ``workerId``, ``hitId``, ``assignmentId``); no participant without a recruiter.
    submit_to : str
        The site to which the end is reported (MTurk: ``turkSubmitTo``).
    version_id : int
        The study version for which the trials were planned.
    arm, arm_design : str
        The arm and its design (see `Place`), kept after the place is lost.
    number : int or None
        The place's number, which decided the trials; None if it is unknown.
    conditions : list of str
        The conditions that this participant compares, the reference first.
    consented_at, started_at, last_active_at, completed_at, withdrawn_at : datetime
        When they consented, saw the first trial, were last active, gave the last answer, and
        withdrew their consent.
    unproven_at : datetime or None
        When somebody resumed it without proof that it was theirs.
    completion_code : str or None
        None before the last answer is stored.
    outcome : str or None
        How it ended: ``completed``, ``failed_attention``, or ``unwatched``, which ends it early
        and without a completion code because too many videos did not play.
    sound_digits : str
        The spoken digits of the sound check; empty before they are drawn.
    sound_tries : int
        Number of wrong tries.
    sound_checked_at : datetime or None
        When they passed the sound check.
    rested_at_position : int or None
        Position of the trial after their last break.
    """

    __tablename__ = "study_sessions"
    __table_args__ = (
        CheckConstraint(
            "(completion_code IS NULL) = (completed_at IS NULL)", name="code_only_when_completed"
        ),
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    token: Mapped[str] = mapped_column(String(64), unique=True)
    visit: Mapped[str | None] = mapped_column(String(64), unique=True)
    recruiter_participant: Mapped[str | None] = mapped_column(String(200), unique=True)
    recruiter_study: Mapped[str] = mapped_column(String(200), default="")
    recruiter_session: Mapped[str] = mapped_column(String(200), default="")
    submit_to: Mapped[str] = mapped_column(String(200), default="", server_default=text("''"))
    version_id: Mapped[int] = mapped_column(ForeignKey("study_versions.id"))
    arm: Mapped[str] = mapped_column(String(202))
    arm_design: Mapped[str] = mapped_column(String(64))
    number: Mapped[int | None]
    conditions: Mapped[list[str]] = mapped_column(JSON)
    consented_at: Mapped[datetime]
    started_at: Mapped[datetime | None]
    last_active_at: Mapped[datetime]
    completed_at: Mapped[datetime | None]
    withdrawn_at: Mapped[datetime | None]
    unproven_at: Mapped[datetime | None]
    completion_code: Mapped[str | None] = mapped_column(String(32), unique=True)
    outcome: Mapped[str | None] = mapped_column(String(20))
    sound_digits: Mapped[str] = mapped_column(String(8), default="", server_default=text("''"))
    sound_tries: Mapped[int] = mapped_column(default=0, server_default=text("0"))
    sound_checked_at: Mapped[datetime | None]
    rested_at_position: Mapped[int | None]

    version: Mapped[StudyVersion] = relationship()
    place: Mapped[Place | None] = relationship(back_populates="study_session")
    trials: Mapped[list[Trial]] = relationship(
        back_populates="study_session", order_by="Trial.position", cascade="all, delete-orphan"
    )
    form_answers: Mapped[list[FormAnswer]] = relationship(
        back_populates="study_session", order_by="FormAnswer.id", cascade="all, delete-orphan"
    )


class Place(Base):
    """One participant's place in an arm.

    A place is held by at most one study session, and a study session holds at most one place.

    Attributes
    ----------
    arm : str
        The arm's name.
    design : str
        Digest of the arm's design. A new version of the study that changes it adds new places;
        otherwise filled places stay filled.
    number : int
        From 0 within the arm; it decides the trials.
    """

    __tablename__ = "places"
    __table_args__ = (UniqueConstraint("arm", "design", "number"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    arm: Mapped[str] = mapped_column(String(202))
    design: Mapped[str] = mapped_column(String(64))
    number: Mapped[int]
    study_session_id: Mapped[int | None] = mapped_column(
        ForeignKey("study_sessions.id", ondelete="SET NULL"), unique=True
    )

    study_session: Mapped[StudySession | None] = relationship(back_populates="place")


class FormAnswer(Base):
    """The only answer to one question about the participant.

    Attributes
    ----------
    stage : str
        ``eligibility``, ``consent``, ``demographics``, ``comprehension`` or ``closing``.
    value : str
        The answer; empty for an unanswered optional question.
    """

    __tablename__ = "form_answers"
    __table_args__ = (UniqueConstraint("study_session_id", "question"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    study_session_id: Mapped[int] = mapped_column(
        ForeignKey("study_sessions.id", ondelete="CASCADE")
    )
    stage: Mapped[str] = mapped_column(String(20))
    question: Mapped[str] = mapped_column(String(100))
    value: Mapped[str] = mapped_column(Text)
    answered_at: Mapped[datetime]

    study_session: Mapped[StudySession] = relationship(back_populates="form_answers")


class Invitation(Base):
    """One personal link; its hash is the `visit` of the study session.

    Attributes
    ----------
    token_hash : str
        SHA-256 of the link's token.
    made_at : datetime
    """

    __tablename__ = "invitations"

    id: Mapped[int] = mapped_column(primary_key=True)
    token_hash: Mapped[str] = mapped_column(String(64), unique=True)
    made_at: Mapped[datetime]


class Newcomer(Base):
    """Somebody anonymous who got a place; removed after an hour.

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
    """One refused request, which changed nothing.

    Attributes
    ----------
    study_session_id : int or None
        The study session of the page; None if the address belongs to nobody.
    kind : str
        See `KINDS` in `studyapp.session.refusal`.
    detail : str
        Details; never an address or a token.
    """

    __tablename__ = "refusals"

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime]
    study_session_id: Mapped[int | None] = mapped_column(
        ForeignKey("study_sessions.id", ondelete="CASCADE"), index=True
    )
    kind: Mapped[str] = mapped_column(String(40))
    detail: Mapped[str] = mapped_column(String(300))
