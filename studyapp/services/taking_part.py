"""Beginning, looking at the present trial, and withdrawing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import median
from typing import Final

from sqlalchemy import select

from studyapp.clock import Clock
from studyapp.definition.form import Stage
from studyapp.definition.study import Study
from studyapp.design.asking import Ask
from studyapp.design.stimulus import Content, Stimulus
from studyapp.models import StudySession, Trial, Video
from studyapp.services.database import Database
from studyapp.services.places import regain_place
from studyapp.services.refusal import ConflictError
from studyapp.services.served_study import ServedStudy
from studyapp.services.sitting import State, current_trial, find, form_due, state_of
from studyapp.services.watching import Watched, watched_so_far

SECONDS_FOR_ANSWERS: Final = 15.0
"""What reading and answering takes beside the video, before the participant's own pace is known."""


@dataclass(frozen=True, kw_only=True)
class ShownVideo:
    """A player of the present trial as far as its page may know it.

    Attributes
    ----------
    shows : tuple of int
        Numbers of the stimuli it shows, 1 for A; 0 is the reference that is not judged.
    muted : bool
        Whether it is to be seen without its sound.
    """

    token: str
    shows: tuple[int, ...]
    duration: float
    muted: bool
    watched: Watched


@dataclass(frozen=True, kw_only=True)
class ShownTrial:
    """The present trial as far as its page may know it.

    Attributes
    ----------
    videos : tuple of ShownVideo
        Its players in the page's order, the reference first where there is one.
    next_videos : tuple of str
        Tokens of the following trial's videos, so that they can be fetched ahead.
    position, presentations : int
        The how manyth trial of how many.
    part : str
        The part of the study it belongs to.
    part_number, parts : int
        The how manyth part of how many; 1 of 1 where all trials are alike.
    begins_part : bool
        Whether it is the first trial of its part.
    asks : tuple of Ask
        The answers it asks for.
    instructed : int or None
        The value that the page asks to choose, on an attention check.
    is_practice : bool
        Whether its answers are discarded; only some studies tell.
    minutes_left : int
        From the participant's own pace, at least 1.
    """

    token: str
    videos: tuple[ShownVideo, ...]
    next_videos: tuple[str, ...]
    position: int
    presentations: int
    part: str
    part_number: int
    parts: int
    begins_part: bool
    asks: tuple[Ask, ...]
    instructed: int | None
    is_practice: bool
    emotion: str
    minutes_left: int


@dataclass(frozen=True, kw_only=True)
class Situation:
    """What a participant's page shows.

    Attributes
    ----------
    presentations, practice : int
        How many trials there are, and how many of them are practice.
    form : {'demographics', 'closing'} or None
        Questions about the participant that are to be answered before anything else.
    """

    state: State
    presentations: int
    practice: int
    form: Stage | None = None
    completion_code: str | None = None
    trial: ShownTrial | None = None


def look(database: Database, served: ServedStudy, token: str, clock: Clock) -> Situation:
    """Return where the participant stands, and mark the present trial as shown.

    A participant who lost the place to a long pause gets it back, if nobody else has it now.
    """
    with database.writing() as session:
        study_session = find(session, token)
        now = clock.now()
        regain_place(session, served, study_session)
        state = state_of(study_session)
        trial = current_trial(study_session)
        if state in ("instructed", "started"):
            study_session.last_active_at = now
        if state == "started" and trial is not None and trial.shown_at is None:
            trial.shown_at = now
        return Situation(
            state=state,
            presentations=len(study_session.trials),
            practice=sum(planned.kind == "practice" for planned in study_session.trials),
            form=form_due(study_session, served.study)
            if state in ("instructed", "started")
            else None,
            completion_code=study_session.completion_code,
            trial=_shown(study_session, trial, served.study)
            if state == "started" and trial is not None
            else None,
        )


def _shown(study_session: StudySession, trial: Trial, study: Study) -> ShownTrial:
    following = [later for later in study_session.trials if later.position > trial.position]
    paces = [known.seconds for known in study_session.trials if known.seconds is not None]
    duration = sum(video.duration for video in trial.videos)
    pace = median(paces) if paces else duration + SECONDS_FOR_ANSWERS
    parts = list(dict.fromkeys(known.part for known in study_session.trials))
    first = next(known for known in study_session.trials if known.part == trial.part)
    return ShownTrial(
        token=trial.token,
        videos=tuple(_shown_video(video, study.watching.coverage) for video in trial.videos),
        next_videos=tuple(video.token for video in following[0].videos) if following else (),
        position=trial.position,
        presentations=len(study_session.trials),
        part=trial.part,
        part_number=1 + parts.index(trial.part),
        parts=len(parts),
        begins_part=trial is first,
        asks=study.asks(trial),
        instructed=trial.instructed,
        is_practice=trial.kind == "practice",
        emotion=trial.emotion,
        minutes_left=max(1, math.ceil((1 + len(following)) * pace / 60)),
    )


def _shown_video(video: Video, coverage: float) -> ShownVideo:
    return ShownVideo(
        token=video.token,
        shows=tuple(stimulus.number for stimulus in video.stimuli),
        duration=video.duration,
        muted=all(stimulus.speech is None for stimulus in video.stimuli),
        watched=watched_so_far(video, coverage),
    )


def begin(database: Database, served: ServedStudy, token: str, clock: Clock) -> None:
    """Start the trials; beginning twice changes nothing, and beginning too early neither."""
    with database.writing() as session:
        study_session = find(session, token)
        waiting = form_due(study_session, served.study) is not None
        if state_of(study_session) == "instructed" and not waiting:
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


def content_of(database: Database, video_token: str) -> Content | None:
    """Return what the video shows that `video_token` may be served for, if any.

    Only the present and the following trial of a running study session have videos: earlier
    ones are settled, later ones nobody has been told of.
    """
    with database.reading() as session:
        video = session.scalars(select(Video).where(Video.token == video_token)).first()
        if video is None or state_of(video.trial.study_session) != "started":
            return None
        present = current_trial(video.trial.study_session)
        if present is None or video.trial.position - present.position not in (0, 1):
            return None
        return tuple(
            Stimulus(condition=shown.condition, segment=shown.segment, speech=shown.speech)
            for shown in video.stimuli
        )
