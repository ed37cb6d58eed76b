"""Beginning, looking at the present trial, and withdrawing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import median
from typing import Final

from sqlalchemy import select

from studyapp.clock import Clock
from studyapp.models import StudySession, Trial
from studyapp.services.database import Database
from studyapp.services.places import regain_place
from studyapp.services.refusal import ConflictError
from studyapp.services.served_study import ServedStudy
from studyapp.services.sitting import State, current_trial, find, state_of
from studyapp.services.watching import Watched, watched_so_far

SECONDS_FOR_ANSWERS: Final = 15.0
"""What reading and answering takes beside the video, before the participant's own pace is known."""


@dataclass(frozen=True, kw_only=True)
class ShownTrial:
    """The present trial as far as its page may know it.

    Attributes
    ----------
    next_media_token : str or None
        The following trial's, so that its video can be fetched ahead.
    position, presentations : int
        The how manyth trial of how many.
    is_practice : bool
        Whether its answers are discarded; only some studies tell.
    minutes_left : int
        From the participant's own pace, at least 1.
    """

    media_token: str
    next_media_token: str | None
    position: int
    presentations: int
    is_practice: bool
    emotion: str
    duration: float
    watched: Watched
    minutes_left: int


@dataclass(frozen=True, kw_only=True)
class Situation:
    """What a participant's page shows."""

    state: State
    presentations: int
    completion_code: str | None = None
    trial: ShownTrial | None = None


def look(database: Database, served: ServedStudy, token: str, clock: Clock) -> Situation:
    """Return where the participant stands, and mark the present trial as shown.

    A participant who lost the place to a long pause gets another one of the same comparison
    back, if one is open.
    """
    with database.writing() as session:
        study_session = find(session, token)
        now = clock.now()
        regain_place(session, served.study, study_session)
        state = state_of(study_session)
        trial = current_trial(study_session)
        if state in ("instructed", "started"):
            study_session.last_active_at = now
        if state == "started" and trial is not None and trial.shown_at is None:
            trial.shown_at = now
        return Situation(
            state=state,
            presentations=len(study_session.trials),
            completion_code=study_session.completion_code,
            trial=_shown(study_session, trial, served.study.watching.coverage)
            if state == "started" and trial is not None
            else None,
        )


def _shown(study_session: StudySession, trial: Trial, coverage: float) -> ShownTrial:
    following = [later for later in study_session.trials if later.position > trial.position]
    paces = [known.seconds for known in study_session.trials if known.seconds is not None]
    pace = median(paces) if paces else trial.duration + SECONDS_FOR_ANSWERS
    return ShownTrial(
        media_token=trial.media_token,
        next_media_token=following[0].media_token if following else None,
        position=trial.position,
        presentations=len(study_session.trials),
        is_practice=trial.kind == "practice",
        emotion=trial.emotion,
        duration=trial.duration,
        watched=watched_so_far(trial, coverage),
        minutes_left=max(1, math.ceil((1 + len(following)) * pace / 60)),
    )


def begin(database: Database, token: str, clock: Clock) -> None:
    """Start the trials; beginning twice changes nothing."""
    with database.writing() as session:
        study_session = find(session, token)
        if state_of(study_session) == "instructed":
            study_session.started_at = study_session.last_active_at = clock.now()


def withdraw(database: Database, token: str, clock: Clock) -> None:
    """Take the consent back: the place is given back and the answers are not exported.

    Raises
    ------
    ConflictError
        If the study session is finished; its completion code may have been used.
    """
    with database.writing() as session:
        study_session = find(session, token)
        if state_of(study_session) == "completed":
            raise ConflictError(
                "You have already finished the study.",
                "To have your answers removed, please write to the people who run it.",
            )
        if study_session.withdrawn_at is None:
            study_session.withdrawn_at = clock.now()
            study_session.place = None


def video_key(database: Database, media_token: str) -> tuple[str, str, str] | None:
    """Return segment and sides of the video that `media_token` may be served for, if any.

    Only the present and the following trial of a running study session have a video: earlier
    ones are settled, later ones nobody has been told of.
    """
    with database.reading() as session:
        trial = session.scalars(select(Trial).where(Trial.media_token == media_token)).first()
        if trial is None or state_of(trial.study_session) != "started":
            return None
        present = current_trial(trial.study_session)
        if present is None or trial.position - present.position not in (0, 1):
            return None
        return trial.segment, trial.left_condition, trial.right_condition
