"""A trial as its page may know it, of a participant or previewed, and how long the rest will take.

A preview shows what somebody in a place would be shown, without anybody taking part.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count
from statistics import median
from typing import Final

from studyapp.database.tables import StudySession, Trial, Video
from studyapp.session.served_study import ServedStudy
from studyapp.session.watch_evidence import Watched, measure_watched
from studyapp.study.design.trial import Ask, PlannedTrial
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
        Which trial it is, from 1, and how many there are.
    part : str
        The part of the study it belongs to.
    part_number, parts : int
        Which part it is, and how many there are; 1 of 1 where all trials are alike.
    begins_part : bool
        Whether it is the first trial of its part.
    asks : tuple of Ask
        The answers it asks for.
    instructed : int or None
        The value that the page asks to choose, on an attention check.
    minutes_left : int
        See `minutes_left`.
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
    emotion: str
    minutes_left: int


SECONDS_FOR_A_PAGE: Final = 8.0
SECONDS_FOR_EACH_VIDEO: Final = 7.0
SECONDS_FOR_EACH_ANSWER: Final = 4.0
"""What reading and answering takes beside the videos, before the participant's pace is known.

Whichever takes longer counts, the videos or, as in ratings and rankings, the many answers.
"""


def expected_seconds(durations: Sequence[float], answers: int) -> float:
    """Return what a trial takes most people.

    Parameters
    ----------
    durations : sequence of float
        Of its videos, in seconds.
    answers : int
        How many it asks for.
    """
    answering = max(SECONDS_FOR_EACH_VIDEO * len(durations), SECONDS_FOR_EACH_ANSWER * answers)
    return SECONDS_FOR_A_PAGE + answering + sum(durations)


def minutes_left(answered: Sequence[tuple[float, float]], remaining: Sequence[float]) -> int:
    """Return the minutes that the remaining trials take at the participant's own pace.

    Breaks are between trials and do not count. One long interruption does not, either: the
    median of the participant's paces decides.

    Parameters
    ----------
    answered : sequence of (float, float)
        Seconds that each answered trial took, and that it was expected to take.
    remaining : sequence of float
        Expected seconds of each trial to come, the present one included.

    Returns
    -------
    int
        At least 1.
    """
    pace = median(took / expected for took, expected in answered) if answered else 1.0
    return max(1, math.ceil(pace * sum(remaining) / 60))


PREVIEW_TOKEN: Final = "preview"  # noqa: S105 - it opens nothing
"""Stands where a participant's own would."""


def shown_trial(
    study_session: StudySession, trial: Trial, study: Study, minutes: int
) -> ShownTrial:
    """Return the present trial of a participant, whose videos are loaded."""
    later = following_trials(study_session, trial)
    return _make_shown_trial(
        study_session.trials,
        trial,
        study,
        minutes,
        token=trial.token,
        videos=tuple(_shown_video(video, study.watching.coverage) for video in trial.videos),
        next_videos=tuple(video.token for video in later[0].videos) if later else (),
        emotion=trial.emotion,
    )


def _make_shown_trial(
    trials: Sequence[Trial] | Sequence[PlannedTrial],
    trial: Trial | PlannedTrial,
    study: Study,
    minutes: int,
    *,
    token: str,
    videos: tuple[ShownVideo, ...],
    next_videos: tuple[str, ...],
    emotion: str,
) -> ShownTrial:
    """Return `trial` among the `trials` of its participant."""
    parts = list(dict.fromkeys(each.part for each in trials))
    return ShownTrial(
        token=token,
        videos=videos,
        next_videos=next_videos,
        position=trial.position,
        presentations=len(trials),
        part=trial.part,
        part_number=1 + parts.index(trial.part),
        parts=len(parts),
        begins_part=trial is next(each for each in trials if each.part == trial.part),
        asks=study.asks(trial),
        instructed=trial.instructed,
        emotion=emotion,
        minutes_left=minutes,
    )


def following_trials(study_session: StudySession, trial: Trial) -> list[Trial]:
    """Return the trials that come after `trial`."""
    return [later for later in study_session.trials if later.position > trial.position]


def _shown_video(video: Video, coverage: float) -> ShownVideo:
    return ShownVideo(
        token=video.token,
        shows=tuple(stimulus.number for stimulus in video.stimuli),
        duration=video.duration,
        muted=video.soundless,
        watched=measure_watched(video, coverage),
    )


def previewed_trial(
    served: ServedStudy, trials: Sequence[PlannedTrial], position: int
) -> ShownTrial:
    """Return the trial at `position` as its page shows it.

    All of its videos count as watched, so that its questions can be answered at once.
    """
    planned, study = trials[position - 1], served.study
    remaining = [
        expected_seconds(_durations(served, trial), len(study.asks(trial)))
        for trial in trials[position - 1 :]
    ]
    return _make_shown_trial(
        trials,
        planned,
        study,
        minutes_left((), remaining),
        token=PREVIEW_TOKEN,
        videos=_previewed_videos(served, planned),
        next_videos=(),
        emotion=planned.segment.emotion,
    )


def _durations(served: ServedStudy, planned: PlannedTrial) -> list[float]:
    return [served.videos[content].duration for content in planned.players.values()]


def _previewed_videos(served: ServedStudy, planned: PlannedTrial) -> tuple[ShownVideo, ...]:
    shown, judged = [], count(1)
    for number, content in planned.players.items():
        duration = served.videos[content].duration
        shown.append(
            ShownVideo(
                token=str(number),
                shows=tuple(next(judged) if number else 0 for _ in content),
                duration=duration,
                muted=all(stimulus.speech is None for stimulus in content),
                watched=Watched(intervals=((0.0, duration),), missing=0.0, next_batch=0),
            )
        )
    return tuple(shown)
