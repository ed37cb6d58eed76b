"""Trials as somebody in a place would be shown them, without anybody taking part."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from studyapp.session.participation import ShownTrial, ShownVideo
from studyapp.session.served_study import ServedStudy
from studyapp.session.time_left import expected_seconds, minutes_left
from studyapp.session.videos.watch_evidence import Watched
from studyapp.study.design.arm import Arm
from studyapp.study.design.planned_trial import PlannedTrial
from studyapp.study.design.stimulus import Content

TOKEN: Final = "preview"  # noqa: S105 - it opens nothing
"""Stands where a participant's own would."""


def planned_trials(served: ServedStudy, arm: Arm, number: int) -> Sequence[PlannedTrial]:
    """Return the trials of a place; of an adaptive study, those before anybody has answered."""
    return served.study.plan(arm, number, served.segments)


def players(planned: PlannedTrial) -> dict[int, Content]:
    """Return what each video shows, by its number; 0 shows the reference."""
    judged = dict(enumerate(planned.videos, start=1))
    return judged if planned.reference is None else {0: (planned.reference,), **judged}


def previewed_trial(
    served: ServedStudy, trials: Sequence[PlannedTrial], position: int
) -> ShownTrial:
    """Return the trial at `position` as its page shows it.

    All of its videos count as watched, so that its questions can be answered at once.
    """
    planned = trials[position - 1]
    parts = list(dict.fromkeys(trial.part for trial in trials))
    first = next(trial for trial in trials if trial.part == planned.part)
    return ShownTrial(
        token=TOKEN,
        videos=_videos(served, planned),
        next_videos=(),
        position=position,
        presentations=len(trials),
        part=planned.part,
        part_number=1 + parts.index(planned.part),
        parts=len(parts),
        begins_part=planned is first,
        asks=served.study.asks(planned),
        instructed=planned.instructed,
        is_practice=planned.kind == "practice",
        emotion=planned.segment.emotion,
        minutes_left=minutes_left(
            (),
            [
                expected_seconds(_durations(served, trial), len(served.study.asks(trial)))
                for trial in trials[position - 1 :]
            ],
        ),
    )


def _durations(served: ServedStudy, planned: PlannedTrial) -> list[float]:
    return [served.videos[content].duration for content in players(planned).values()]


def _videos(served: ServedStudy, planned: PlannedTrial) -> tuple[ShownVideo, ...]:
    shown, judged = [], 0
    for number, content in players(planned).items():
        numbers = (0,) if number == 0 else tuple(range(judged + 1, judged + len(content) + 1))
        judged += len(content) if number else 0
        duration = served.videos[content].duration
        shown.append(
            ShownVideo(
                token=str(number),
                shows=numbers,
                duration=duration,
                muted=all(stimulus.speech is None for stimulus in content),
                watched=Watched(intervals=((0.0, duration),), missing=0.0, next_batch=0),
            )
        )
    return tuple(shown)
