"""Trials, their stimuli and videos, the answers, and watch records."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import (
    JSON,
    CheckConstraint,
    ForeignKey,
    ForeignKeyConstraint,
    Index,
    String,
    UniqueConstraint,
    text,
)
from sqlalchemy.orm import Mapped, mapped_column, relationship

from studyapp.database.tables.base import Base
from studyapp.database.tables.study_session import StudySession


class Trial(Base):
    """One presentation of one or more stimuli to one participant.

    Attributes
    ----------
    token : str
        Random name of the trial in the browser.
    position : int
        Position within the study session, from 1.
    kind : str
        ``practice``, ``main``, ``repeat``, ``catch`` or ``attention``.
    part : str
        The set, block or task it belongs to; empty in a study without parts.
    segment, emotion, speaker : str
        The speech it is about.
    expected : int or None
        Number of the obviously better stimulus of a catch trial.
    instructed : int or None
        The value that an attention check asks for.
    repeats : int or None
        Position of the practice trial that a repeat shows again.
    shown_at, answered_at, unplayable_at : datetime
        When the page was first shown, when the answers were stored, and when the trial was skipped
        because a video did not play.
    seconds : float or None
        Time from the first showing to the answer.
    """

    __tablename__ = "trials"
    __table_args__ = (
        UniqueConstraint("study_session_id", "position"),
        CheckConstraint(
            "kind IN ('practice', 'main', 'repeat', 'catch', 'attention')", name="kind"
        ),
        CheckConstraint("(kind = 'catch') = (expected IS NOT NULL)", name="expected"),
        CheckConstraint("(kind = 'attention') = (instructed IS NOT NULL)", name="instructed"),
        CheckConstraint("answered_at IS NULL OR unplayable_at IS NULL", name="one_outcome"),
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    study_session_id: Mapped[int] = mapped_column(
        ForeignKey("study_sessions.id", ondelete="CASCADE")
    )
    token: Mapped[str] = mapped_column(String(64), unique=True)
    position: Mapped[int]
    kind: Mapped[str] = mapped_column(String(10))
    part: Mapped[str] = mapped_column(String(100), default="")
    segment: Mapped[str] = mapped_column(String(100))
    emotion: Mapped[str] = mapped_column(String(100))
    speaker: Mapped[str] = mapped_column(String(200))
    expected: Mapped[int | None]
    instructed: Mapped[int | None]
    repeats: Mapped[int | None]
    shown_at: Mapped[datetime | None]
    answered_at: Mapped[datetime | None]
    unplayable_at: Mapped[datetime | None]
    seconds: Mapped[float | None]

    study_session: Mapped[StudySession] = relationship(back_populates="trials")
    videos: Mapped[list[Video]] = relationship(
        back_populates="trial", order_by="Video.number", cascade="all, delete-orphan"
    )
    stimuli: Mapped[list[TrialStimulus]] = relationship(
        back_populates="trial", order_by="TrialStimulus.number", cascade="all, delete-orphan"
    )
    responses: Mapped[list[Response]] = relationship(
        back_populates="trial", cascade="all, delete-orphan", foreign_keys="Response.trial_id"
    )

    @property
    def settled(self) -> bool:
        """Whether it was answered or skipped."""
        return self.answered_at is not None or self.unplayable_at is not None

    @property
    def conditions(self) -> tuple[str, ...]:
        """The conditions judged, number 1 first; the reference is not."""
        return tuple(shown.condition for shown in self.stimuli if shown.number > 0)


class TrialStimulus(Base):
    """One stimulus that a trial presents.

    Attributes
    ----------
    number : int
        1, 2, … are labelled A, B, … and judged; 0 is the reference.
    condition, segment : str
        Whose motion, and the segment it was made for.
    speech : str or None
        The segment that is heard with it; None for silence.
    """

    __tablename__ = "trial_stimuli"
    __table_args__ = (UniqueConstraint("trial_id", "number"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    trial_id: Mapped[int] = mapped_column(ForeignKey("trials.id", ondelete="CASCADE"))
    video_id: Mapped[int] = mapped_column(ForeignKey("videos.id", ondelete="CASCADE"))
    number: Mapped[int]
    condition: Mapped[str] = mapped_column(String(100))
    segment: Mapped[str] = mapped_column(String(100))
    speech: Mapped[str | None] = mapped_column(String(100))

    trial: Mapped[Trial] = relationship(back_populates="stimuli")
    video: Mapped[Video] = relationship(back_populates="stimuli")


ABOUT_THE_TRIAL = text("stimulus IS NULL")


class Response(Base):
    """The only answer to one question about a trial or one of its stimuli.

    Attributes
    ----------
    stimulus : int or None
        Number of the stimulus it is about; None for the whole trial.
    value : int
        A preference from -2, clearly A, to 2, clearly B; a label from 1 to 5; a slider value from
        0 to 100; or a rank from 1.
    reasons : list of str
        Names of the ticked reasons; in a ranking, each rank has those of the whole ranking.
    """

    __tablename__ = "responses"
    __table_args__ = (
        UniqueConstraint("trial_id", "question", "stimulus"),
        # Unique constraints treat NULLs as different.
        Index(
            "uq_responses_trial_id_question",
            "trial_id",
            "question",
            unique=True,
            sqlite_where=ABOUT_THE_TRIAL,
            postgresql_where=ABOUT_THE_TRIAL,
        ),
        ForeignKeyConstraint(
            ["trial_id", "stimulus"],
            ["trial_stimuli.trial_id", "trial_stimuli.number"],
            name="fk_responses_stimulus",
            ondelete="CASCADE",
        ),
        CheckConstraint("value BETWEEN -2 AND 100", name="value"),
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    trial_id: Mapped[int] = mapped_column(ForeignKey("trials.id", ondelete="CASCADE"))
    question: Mapped[str] = mapped_column(String(100))
    stimulus: Mapped[int | None]
    value: Mapped[int]
    reasons: Mapped[list[str]] = mapped_column(JSON)
    answered_at: Mapped[datetime]

    trial: Mapped[Trial] = relationship(back_populates="responses", foreign_keys=[trial_id])


class Video(Base):
    """One player on a trial's page, and what it plays.

    Attributes
    ----------
    number : int
        From 1 in the page's order; 0 plays the reference.
    token : str
        Random name of the video in the browser.
    duration : float
        Seconds.
    made_from : str
        Digest of everything its picture and sound were made from when the trial was planned.
    sent_at : datetime or None
        When it was first sent, or the browser first redirected to the media store.
    unplayable_at : datetime or None
        When the participant reported that it does not play.
    """

    __tablename__ = "videos"
    __table_args__ = (UniqueConstraint("trial_id", "number"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    trial_id: Mapped[int] = mapped_column(ForeignKey("trials.id", ondelete="CASCADE"))
    number: Mapped[int]
    token: Mapped[str] = mapped_column(String(64), unique=True)
    duration: Mapped[float]
    made_from: Mapped[str] = mapped_column(String(64), default="", server_default=text("''"))
    sent_at: Mapped[datetime | None]
    unplayable_at: Mapped[datetime | None]

    trial: Mapped[Trial] = relationship(back_populates="videos")
    stimuli: Mapped[list[TrialStimulus]] = relationship(
        back_populates="video", order_by="TrialStimulus.number", cascade="all, delete-orphan"
    )

    watch_record: Mapped[WatchRecord | None] = relationship(
        back_populates="video", cascade="all, delete-orphan"
    )

    @property
    def soundless(self) -> bool:
        """Whether it is meant to be seen without sound."""
        return all(shown.speech is None for shown in self.stimuli)


class WatchRecord(Base):
    """All reports of one video together; there is none before the first report.

    Attributes
    ----------
    intervals : list of [float, float]
        The parts that count as watched, from and to, in seconds: disjoint and in order.
    played_seconds : float
        Everything that played, replays included, whether it counts or not.
    rate : float
        Largest playback rate seen; 1 is as recorded.
    hidden_seconds, silent_seconds : float
        How long it played where nobody could see it, and where nobody could hear it.
    stalls : int
    stalled_seconds : float
        How often and how long it waited for data while it was meant to play.
    frames, dropped_frames : int or None
        Pictures that the browser had to show, and those it left out; None where it does not
        count them.
    latest : list of [int, int]
        Number and checksum of the latest reports, in order of their numbers: a report that is
        sent again is known by them.
    reported_at : datetime
        When the latest report came.
    """

    __tablename__ = "watch_records"

    id: Mapped[int] = mapped_column(primary_key=True)
    video_id: Mapped[int] = mapped_column(ForeignKey("videos.id", ondelete="CASCADE"), unique=True)
    intervals: Mapped[list[list[float]]] = mapped_column(JSON)
    played_seconds: Mapped[float]
    rate: Mapped[float]
    hidden_seconds: Mapped[float]
    silent_seconds: Mapped[float]
    stalls: Mapped[int]
    stalled_seconds: Mapped[float]
    frames: Mapped[int | None]
    dropped_frames: Mapped[int | None]
    latest: Mapped[list[list[int]]] = mapped_column(JSON)
    reported_at: Mapped[datetime]

    video: Mapped[Video] = relationship(back_populates="watch_record")
