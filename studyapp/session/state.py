"""Where a study session stands."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from types import MappingProxyType
from typing import Final, Literal, Protocol

from sqlalchemy import select
from sqlalchemy.orm import Session

from studyapp.database.tables import StudySession, Trial, Video
from studyapp.session.refusal import ConflictError, NotTheirsError, UnknownAddressError
from studyapp.session.rows import load_place_and_trials, load_video
from studyapp.study.design.message import Message
from studyapp.study.settings.form import Stage
from studyapp.study.settings.study import Study

State = Literal["instructed", "started", "completed", "unwatched", "withdrawn", "lapsed"]

NOT_AT_A_TRIAL: Final[Mapping[State, Message]] = MappingProxyType(
    {
        "instructed": Message("You have not begun yet."),
        "completed": Message("You have already finished: all your answers are stored."),
        "unwatched": Message("Too many videos did not play, and so the study has ended here."),
        "withdrawn": Message("You have withdrawn from this study."),
        "lapsed": Message("Your place was given to somebody else after a long pause."),
    }
)
"""Why somebody who has not started, or no longer takes part, has no trial."""


def find(session: Session, token: str, *, to_change: bool = True) -> StudySession:
    """Return the study session with this token, by default kept from other writers until stored.

    What belongs to it must be loaded after it, not with it: whoever waited for another writer
    would see its trials and its place as they were before.

    Raises
    ------
    UnknownAddressError
        If there is none.
    """
    wanted = select(StudySession).where(StudySession.token == token)
    found = session.scalars(wanted.with_for_update() if to_change else wanted).first()
    if found is None:
        raise UnknownAddressError(
            "This address belongs to no participant of this study.",
            "Please open the link you were given once more; nothing you answered is lost.",
        )
    load_place_and_trials(session, found)
    return found


class Stands(Protocol):
    """What must be known of a study session to tell where it stands; each may be None."""

    @property
    def withdrawn_at(self) -> datetime | None:
        """When they withdrew."""

    @property
    def completed_at(self) -> datetime | None:
        """When the last answer was stored."""

    @property
    def outcome(self) -> str | None:
        """How it ended."""

    @property
    def place(self) -> object | None:
        """What they hold."""

    @property
    def started_at(self) -> datetime | None:
        """When they saw the first trial."""


def state_of(study_session: Stands) -> State:
    """Return where `study_session` stands.

    ``instructed`` has agreed but not yet begun, ``unwatched`` was ended since too many videos did
    not play, ``lapsed`` was silent for so long that its place was given back.
    """
    if study_session.withdrawn_at is not None:
        return "withdrawn"
    if study_session.completed_at is not None:
        return "completed"
    if study_session.outcome is not None:
        return "unwatched"
    if study_session.place is None:
        return "lapsed"
    return "instructed" if study_session.started_at is None else "started"


def current_trial(study_session: StudySession) -> Trial | None:
    """Return the trial to be shown, None when there is none left."""
    return next((trial for trial in study_session.trials if not trial.settled), None)


def form_due(study_session: StudySession, study: Study) -> Stage | None:
    """Return the stage of questions about the participant that is to be answered now, if any."""
    if study_session.started_at is None:
        stage: Stage = "demographics"
    elif current_trial(study_session) is None:
        stage = "closing"
    else:
        return None
    answered = {answer.question for answer in study_session.form_answers}
    asked = {question.name for question in study.form.asked(stage)}
    return stage if asked - answered else None


def require_present(study_session: StudySession, trial: Trial) -> datetime:
    """Return when `trial` was first shown, if it is what `study_session` stands at.

    Raises
    ------
    ConflictError
        If it is not the present trial, or none is being shown.
    """
    state = state_of(study_session)
    if state != "started":
        raise ConflictError(
            "{problem}",
            "The next page shows how to go on.",
            problem=NOT_AT_A_TRIAL[state],
        )
    if trial is not current_trial(study_session) or trial.shown_at is None:
        raise ConflictError(
            "This is not the page you are on.",
            "Perhaps the study is open in two windows. Please go on here; nothing is lost.",
        )
    return trial.shown_at


def trial_of(study_session: StudySession, trial_token: str) -> Trial:
    """Return the trial that `trial_token` names.

    Raises
    ------
    NotTheirsError
        If it is none of this study session.
    """
    for trial in study_session.trials:
        if trial.token == trial_token:
            return trial
    raise _not_theirs()


def video_of(session: Session, study_session: StudySession, video_token: str) -> Video:
    """Return the video that `video_token` names.

    Raises
    ------
    NotTheirsError
        If it is none of this study session.
    """
    found = load_video(session, study_session, video_token)
    if found is None:
        raise _not_theirs()
    return found


def _not_theirs() -> NotTheirsError:
    return NotTheirsError(
        "This page does not belong to you.",
        "Go on with your own; nothing you answered is lost.",
    )
