"""Beginning, and looking at where the participant stands."""

from __future__ import annotations

from dataclasses import dataclass, replace

from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import StudySession, Trial, Video
from studyapp.session.arrival.places import regain_place
from studyapp.session.breaks import break_due
from studyapp.session.departure import Leaving, leaving
from studyapp.session.served_study import ServedStudy
from studyapp.session.sound_check import draw_digits, left_unheard, sound_check_due
from studyapp.session.state import (
    State,
    current_trial,
    durations_of,
    find,
    form_due,
    load_videos,
    note,
    state_of,
)
from studyapp.session.time_left import expected_seconds, minutes_left
from studyapp.session.videos.watch_evidence import Watched, watched_so_far
from studyapp.study.design.asking import Ask
from studyapp.study.settings.form import Stage
from studyapp.study.settings.study import Study


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
        See `studyapp.session.time_left`.
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
class Break:
    """A break between two trials.

    Attributes
    ----------
    position : int
        Of the trial that comes after it.
    done : int
        How many trials there have been.
    minutes_left : int
        See `studyapp.session.time_left`.
    """

    position: int
    done: int
    minutes_left: int


@dataclass(frozen=True, kw_only=True)
class Situation:
    """What a participant's page shows; of what is due, the first in this order.

    Attributes
    ----------
    presentations, practice : int
        How many trials there are, and how many of them are practice.
    sound_tries : int or None
        How often other digits were typed; None where the sound check is not due.
    form : {'demographics', 'closing'} or None
        Questions about the participant that are to be answered before anything else.
    rest : Break or None
        A break that is offered now.
    leaving : Leaving or None
        The completion code and the way back; None before the end is stored.
    trial : ShownTrial or None
        What is to be judged now.
    left_unheard : bool
        Whether they withdrew since they could not hear the sound.
    """

    state: State
    presentations: int
    practice: int
    sound_tries: int | None = None
    form: Stage | None = None
    rest: Break | None = None
    leaving: Leaving | None = None
    trial: ShownTrial | None = None
    left_unheard: bool = False

    @property
    def completion_code(self) -> str | None:
        """The completion code; None before the end is stored."""
        return None if self.leaving is None else self.leaving.code


def look(database: Database, served: ServedStudy, token: str, clock: Clock) -> Situation:
    """Return where the participant stands, and mark the present trial as shown.

    A participant who lost the place to a long pause gets it back, if nobody else has it now.
    """
    # Nothing that is loaded here depends on what is changed here.
    with database.writing() as session, session.no_autoflush:
        study_session = find(session, token)
        regain_place(session, served, study_session)
        situation = Situation(
            state=state_of(study_session),
            presentations=len(study_session.trials),
            practice=sum(planned.kind == "practice" for planned in study_session.trials),
            leaving=leaving(served.study.recruitment, study_session),
            left_unheard=left_unheard(study_session),
        )
        if situation.state not in ("instructed", "started"):
            return situation
        now = clock.now()
        note(session, study_session, last_active_at=now)
        if sound_check_due(study_session, served):
            draw_digits(study_session)
            return replace(situation, sound_tries=study_session.sound_tries)
        form = form_due(study_session, served.study)
        trial = current_trial(study_session)
        if form is not None or situation.state == "instructed" or trial is None:
            return replace(situation, form=form)
        minutes = _minutes_left(session, study_session, served.study)
        if (position := break_due(study_session, served.study)) is not None:
            rest = Break(position=position, done=position - 1, minutes_left=minutes)
            return replace(situation, rest=rest)
        load_videos(session, [trial, *_following(study_session, trial)[:1]])
        if trial.shown_at is None:
            note(session, trial, shown_at=now)
        return replace(situation, trial=_shown(study_session, trial, served.study, minutes))


def _minutes_left(session: Session, study_session: StudySession, study: Study) -> int:
    durations = durations_of(session, study_session)
    expected = {
        trial: expected_seconds(durations[trial.id], len(study.asks(trial)))
        for trial in study_session.trials
    }
    return minutes_left(
        [(t.seconds, expected[t]) for t in study_session.trials if t.seconds is not None],
        [expected[trial] for trial in study_session.trials if not trial.settled],
    )


def _shown(study_session: StudySession, trial: Trial, study: Study, minutes: int) -> ShownTrial:
    following = _following(study_session, trial)
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
        minutes_left=minutes,
    )


def _following(study_session: StudySession, trial: Trial) -> list[Trial]:
    return [later for later in study_session.trials if later.position > trial.position]


def _shown_video(video: Video, coverage: float) -> ShownVideo:
    return ShownVideo(
        token=video.token,
        shows=tuple(stimulus.number for stimulus in video.stimuli),
        duration=video.duration,
        muted=video.soundless,
        watched=watched_so_far(video, coverage),
    )


def begin(database: Database, served: ServedStudy, token: str, clock: Clock) -> None:
    """Start the trials; beginning twice changes nothing, and beginning too early neither."""
    with database.writing() as session:
        study_session = find(session, token)
        waiting = (
            sound_check_due(study_session, served)
            or form_due(study_session, served.study) is not None
        )
        if state_of(study_session) == "instructed" and not waiting:
            study_session.started_at = study_session.last_active_at = clock.now()
