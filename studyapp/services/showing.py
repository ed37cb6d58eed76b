"""What a video's address may show at this moment."""

from __future__ import annotations

from typing import Final

from sqlalchemy import bindparam, func, select
from sqlalchemy.orm import aliased

from studyapp.design.stimulus import Content, Stimulus
from studyapp.models import StudySession, Trial, TrialStimulus, Video
from studyapp.services.database import Database

_Other = aliased(Trial)

PRESENT_POSITION: Final = (
    select(func.min(_Other.position))
    .where(
        _Other.study_session_id == Trial.study_session_id,
        _Other.answered_at.is_(None),
        _Other.unplayable_at.is_(None),
    )
    .correlate(Trial)
    .scalar_subquery()
)
"""Where a study session stands (see `studyapp.services.sitting.current_trial`)."""

RUNNING: Final = (
    StudySession.started_at.is_not(None),
    StudySession.completed_at.is_(None),
    StudySession.withdrawn_at.is_(None),
)
"""Who has trials to take, if the place is still theirs (see `sitting.state_of`)."""

SHOWN: Final = (
    select(TrialStimulus.condition, TrialStimulus.segment, TrialStimulus.speech)
    .join(TrialStimulus.video)
    .join(Video.trial)
    .join(Trial.study_session)
    .join(StudySession.place)
    .where(
        Video.token == bindparam("token"),
        *RUNNING,
        (Trial.position - PRESENT_POSITION).in_((0, 1)),
    )
    .order_by(TrialStimulus.number)
)


def content_of(database: Database, video_token: str) -> Content | None:
    """Return what the video shows that `video_token` may be served for, if any.

    Only the present and the following trial of a running study session have videos: earlier
    ones are settled, later ones nobody has been told of. Videos are what is asked for most, so
    this is one statement.
    """
    with database.looking_up() as connection:
        shown = connection.execute(SHOWN, {"token": video_token}).all()
    stimuli = (
        Stimulus(condition=condition, segment=segment, speech=speech)
        for condition, segment, speech in shown
    )
    return tuple(stimuli) or None
