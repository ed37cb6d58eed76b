"""A participant's trials: their rows, what their pages may know, and the time left in the study."""

import math
import secrets
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count
from statistics import median
from typing import Any, Final

from sqlalchemy import insert
from sqlalchemy.orm import Session

from studyapp.database.tables.trial import Trial, TrialStimulus, Video
from studyapp.session.served_study import ServedStudy
from studyapp.session.watch_evidence import Watched, measure_watched
from studyapp.study.design.trial import Ask, Content, PlannedTrial, Stimulus
from studyapp.study.settings.study import Study

TOKEN_BYTES: Final = 24
"""Random bytes of every token: 192 bits."""


def new_token() -> str:
    """Return a random token that nobody can guess."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def store_trials(
    session: Session, study_session_id: int, planned: Sequence[PlannedTrial], served: ServedStudy
) -> None:
    """Store the planned trials with their videos and stimuli.

    One statement a table: objects for the 150 rows took longer than all else in an enrolment.
    """
    trials = [{**_trial_row(trial), "study_session_id": study_session_id} for trial in planned]
    planned_by_id = dict(zip(_insert_rows(session, Trial, trials), planned, strict=True))
    videos = [
        {**_video_row(player, content, served), "trial_id": trial_id}
        for trial_id, trial in planned_by_id.items()
        for player, content in trial.players.items()
    ]
    numbers = [(video["trial_id"], video["number"]) for video in videos]
    video_ids = dict(zip(numbers, _insert_rows(session, Video, videos), strict=True))
    stimuli = [
        {
            **_stimulus_row(number, stimulus),
            "trial_id": trial_id,
            "video_id": video_ids[trial_id, player],
        }
        for trial_id, trial in planned_by_id.items()
        for player, number, stimulus in numbered_stimuli(trial.players)
    ]
    session.connection().execute(insert(TrialStimulus), stimuli)


def _insert_rows(
    session: Session, model: type[Trial] | type[Video], rows: Sequence[dict[str, Any]]
) -> list[int]:
    """Store `rows`, and return their ids in the same order.

    Databases return ids in any order; asked for the order of `rows`, SQLite stores one at a time.
    """
    storing = insert(model).returning(model.token, model.id)
    ids = dict(session.connection().execute(storing, rows).all())
    return [ids[row["token"]] for row in rows]


def make_trial(planned: PlannedTrial, served: ServedStudy) -> Trial:
    """Return a planned trial with its videos and stimuli, not to be stored."""
    videos = {
        player: Video(**_video_row(player, content, served))
        for player, content in planned.players.items()
    }
    trial = Trial(**_trial_row(planned), videos=list(videos.values()))
    for player, number, stimulus in numbered_stimuli(planned.players):
        row = TrialStimulus(**_stimulus_row(number, stimulus), video=videos[player])
        trial.stimuli.append(row)
    return trial


def _trial_row(planned: PlannedTrial) -> dict[str, Any]:
    return {
        "token": new_token(),
        "position": planned.position,
        "kind": planned.kind,
        "part": planned.part,
        "segment": planned.segment.name,
        "emotion": planned.segment.emotion,
        "speaker": planned.segment.speaker,
        "expected": planned.expected,
        "instructed": planned.instructed,
        "repeats": planned.repeats,
    }


def _video_row(player: int, content: Content, served: ServedStudy) -> dict[str, Any]:
    file = served.videos[content]
    return {
        "token": new_token(),
        "number": player,
        "duration": file.duration,
        "made_from": file.made_from,
    }


def _stimulus_row(number: int, stimulus: Stimulus) -> dict[str, Any]:
    return {
        "number": number,
        "condition": stimulus.condition,
        "segment": stimulus.segment,
        "speech": stimulus.speech,
    }


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


def shown_trial(trials: Sequence[Trial], trial: Trial, study: Study, minutes: int) -> ShownTrial:
    """Return `trial`, one of a participant's `trials`, as its page may know it.

    Its videos and those of the next trial must be loaded.
    """
    parts = list(dict.fromkeys(each.part for each in trials))
    later = following_trials(trials, trial)
    return ShownTrial(
        token=trial.token,
        videos=tuple(_shown_video(video, study.watching.coverage) for video in trial.videos),
        next_videos=tuple(video.token for video in later[0].videos) if later else (),
        position=trial.position,
        presentations=len(trials),
        part=trial.part,
        part_number=1 + parts.index(trial.part),
        parts=len(parts),
        begins_part=trial is next(each for each in trials if each.part == trial.part),
        asks=study.asks(trial),
        instructed=trial.instructed,
        emotion=trial.emotion,
        minutes_left=minutes,
    )


def following_trials(trials: Sequence[Trial], trial: Trial) -> list[Trial]:
    """Return the `trials` after `trial`."""
    return [later for later in trials if later.position > trial.position]


def _shown_video(video: Video, coverage: float) -> ShownVideo:
    return ShownVideo(
        token=video.token,
        shows=tuple(stimulus.number for stimulus in video.stimuli),
        duration=video.duration,
        muted=video.soundless,
        watched=measure_watched(video, coverage),
    )


PREVIEW_TOKEN: Final = "preview"  # noqa: S105 - it opens nothing
"""Takes the place of a participant's token."""


def previewed_trial(
    served: ServedStudy, planned: Sequence[PlannedTrial], position: int
) -> ShownTrial:
    """Return the trial at `position` for a preview, with all its videos watched."""
    trials = [make_trial(each, served) for each in planned]
    trial, study = trials[position - 1], served.study
    remaining = [
        expected_seconds([video.duration for video in each.videos], len(study.asks(each)))
        for each in trials[position - 1 :]
    ]
    shown = shown_trial(trials, trial, study, minutes_left((), remaining))
    videos = tuple(
        replace(
            video,
            token=str(row.number),
            watched=Watched(intervals=((0.0, video.duration),), missing=0.0, next_batch=0),
        )
        for row, video in zip(trial.videos, shown.videos, strict=True)
    )
    return replace(shown, token=PREVIEW_TOKEN, videos=videos, next_videos=())
