"""Storing the trials that were planned for a participant, table by table.

Row by row, which is how the unit of work stores what gets its number from SQLite, the trials of
one participant take a hundred statements and more.
"""

from __future__ import annotations

import secrets
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final, cast

from sqlalchemy import Table, bindparam, insert, select
from sqlalchemy.orm import Session

from studyapp.design.planned_trial import PlannedTrial
from studyapp.design.stimulus import Content
from studyapp.models import Trial, TrialStimulus, Video
from studyapp.services.served_study import ServedStudy

TOKEN_BYTES: Final = 24
"""Random bytes of every token: 192 bits."""

TRIALS: Final = insert(cast(Table, Trial.__table__))
VIDEOS: Final = insert(cast(Table, Video.__table__))
STIMULI: Final = insert(cast(Table, TrialStimulus.__table__))
TRIALS_OF: Final = select(Trial.position, Trial.id).where(
    Trial.study_session_id == bindparam("study_session_id")
)
VIDEOS_OF: Final = (
    select(Trial.position, Video.number, Video.id)
    .join(Video.trial)
    .where(Trial.study_session_id == bindparam("study_session_id"))
)


def new_token() -> str:
    """Return a random name that nobody can guess."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def store_trials(
    session: Session, study_session_id: int, planned: Sequence[PlannedTrial], served: ServedStudy
) -> None:
    """Store `planned`, the videos that show them and what these present."""
    connection = session.connection()
    own = {"study_session_id": study_session_id}
    connection.execute(TRIALS, [_trial(trial) | own for trial in planned])
    trials = {row.position: row.id for row in connection.execute(TRIALS_OF, own)}
    connection.execute(
        VIDEOS,
        [
            {
                "trial_id": trials[trial.position],
                "number": number,
                "token": new_token(),
                "duration": served.videos[content].duration,
            }
            for trial in planned
            for number, content in _players(trial)
        ],
    )
    videos = {
        (position, number): video for position, number, video in connection.execute(VIDEOS_OF, own)
    }
    connection.execute(
        STIMULI,
        [
            {
                "trial_id": trials[trial.position],
                "video_id": videos[trial.position, player],
                **stimulus,
            }
            for trial in planned
            for player, stimulus in _stimuli(trial)
        ],
    )


def _trial(planned: PlannedTrial) -> dict[str, Any]:
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


def _players(planned: PlannedTrial) -> Iterator[tuple[int, Content]]:
    """Yield the number of each video and what it shows; 0 shows the reference."""
    if planned.reference is not None:
        yield 0, (planned.reference,)
    yield from enumerate(planned.videos, start=1)


def _stimuli(planned: PlannedTrial) -> Iterator[tuple[int, Mapping[str, Any]]]:
    """Yield the number of its video and the columns of each stimulus; 0 is the reference."""
    judged = 0
    for player, content in _players(planned):
        for stimulus in content:
            judged += player > 0
            yield (
                player,
                {
                    "number": judged if player > 0 else 0,
                    "condition": stimulus.condition,
                    "segment": stimulus.segment,
                    "speech": stimulus.speech,
                },
            )
