"""What a trial's page may know, for participants and previews, and the time left in the study."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from statistics import median
from typing import Final

from studyapp.database.tables import StudySession, Trial, Video
from studyapp.session.served_study import ServedStudy
from studyapp.session.watch_evidence import Watched, measure_watched
from studyapp.study.design.trial import Ask, Content, PlannedTrial, Stimulus
from studyapp.study.settings.study import Study


@dataclass(frozen=True, kw_only=True)
class ShownVideo:
    """A player on a trial's page.

    Attributes
    ----------
    shows : tuple of int
        Numbers of its stimuli, 1 for A; 0 is the reference.
    muted : bool
        Whether it has no sound.
    """

    token: str
    shows: tuple[int, ...]
    duration: float
    muted: bool
    watched: Watched


@dataclass(frozen=True, kw_only=True)
class ShownTrial:
    """A trial as its page may know it.

    Attributes
    ----------
    videos : tuple of ShownVideo
        Its players in the page's order, the reference first.
    next_videos : tuple of str
        Tokens of the next trial's videos, to be prefetched.
    position, presentations : int
        The trial's position, from 1, and the number of trials.
    part : str
        The part of the study it belongs to.
    part_number, parts : int
        The part's number, from 1, and the number of parts.
    begins_part : bool
        Whether it is the first trial of its part.
    asks : tuple of Ask
        The answers it asks for.
    instructed : int or None
        The value that an attention check asks for.
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
"""Time for reading and answering, before the participant's pace is known.

The longer of the last two counts: ratings and rankings ask for many answers.
"""


def expected_seconds(durations: Sequence[float], answers: int) -> float:
    """Return the seconds that most people need for a trial.

    Parameters
    ----------
    durations : sequence of float
        Durations of its videos, in seconds.
    answers : int
        Number of answers.
    """
    answering = max(SECONDS_FOR_EACH_VIDEO * len(durations), SECONDS_FOR_EACH_ANSWER * answers)
    return SECONDS_FOR_A_PAGE + answering + sum(durations)


def minutes_left(answered: Sequence[tuple[float, float]], remaining: Sequence[float]) -> int:
    """Return the minutes that the remaining trials take at the participant's pace.

    The pace is the median over trials, so that breaks and interruptions do not count.

    Parameters
    ----------
    answered : sequence of (float, float)
        Actual and expected seconds of each answered trial.
    remaining : sequence of float
        Expected seconds of each remaining trial, the current one included.

    Returns
    -------
    int
        At least 1.
    """
    pace = median(took / expected for took, expected in answered) if answered else 1.0
    return max(1, math.ceil(pace * sum(remaining) / 60))


PREVIEW_TOKEN: Final = "preview"  # noqa: S105 - it opens nothing
"""Takes the place of a participant's token."""


def shown_trial(
    study_session: StudySession, trial: Trial, study: Study, minutes: int
) -> ShownTrial:
    """Return the current trial of a participant; its videos must be loaded."""
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
    """Return the trials after `trial`."""
    return [later for later in study_session.trials if later.position > trial.position]


def _shown_video(video: Video, coverage: float) -> ShownVideo:
    return ShownVideo(
        token=video.token,
        shows=tuple(stimulus.number for stimulus in video.stimuli),
        duration=video.duration,
        muted=video.soundless,
        watched=measure_watched(video, coverage),
    )


def numbered_stimuli(players: Mapping[int, Content]) -> Iterator[tuple[int, int, Stimulus]]:
    """Yield each stimulus with the number of its player and its own: 1 for A; 0 is the reference.

    Parameters
    ----------
    players : mapping of int to Content
        The content of each player, by its number; 0 is the reference.
    """
    judged = count(1)
    for player, content in sorted(players.items()):
        for stimulus in content:
            yield player, next(judged) if player else 0, stimulus


def previewed_trial(
    served: ServedStudy, trials: Sequence[PlannedTrial], position: int
) -> ShownTrial:
    """Return the trial at `position` for a preview, with all its videos watched."""
    planned, study = trials[position - 1], served.study
    remaining = [
        expected_seconds(
            [served.videos[content].duration for content in trial.shown], len(study.asks(trial))
        )
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


def _previewed_videos(served: ServedStudy, planned: PlannedTrial) -> tuple[ShownVideo, ...]:
    shown = []
    numbered = list(numbered_stimuli(planned.players))
    for player, content in planned.players.items():
        duration = served.videos[content].duration
        shown.append(
            ShownVideo(
                token=str(player),
                shows=tuple(number for shown_by, number, _ in numbered if shown_by == player),
                duration=duration,
                muted=all(stimulus.speech is None for stimulus in content),
                watched=Watched(intervals=((0.0, duration),), missing=0.0, next_batch=0),
            )
        )
    return tuple(shown)
