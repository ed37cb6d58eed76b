"""What a participant's videos before one of them show."""

from __future__ import annotations

from itertools import groupby
from typing import Final

from sqlalchemy import bindparam, select
from sqlalchemy.orm import aliased

from studyapp.design.stimulus import Content, Stimulus
from studyapp.models import Trial, TrialStimulus, Video
from studyapp.services.database import Database

_Asked = aliased(Video)
_AskedTrial = aliased(Trial)

ALL: Final = (
    select(Video.token, TrialStimulus.condition, TrialStimulus.segment, TrialStimulus.speech)
    .join(TrialStimulus.video)
    .join(Video.trial)
    .where(
        Trial.study_session_id
        == select(_AskedTrial.study_session_id)
        .join(_Asked, _Asked.trial_id == _AskedTrial.id)
        .where(_Asked.token == bindparam("token"))
        .scalar_subquery()
    )
    .order_by(Trial.position, Video.number, TrialStimulus.number)
)


def earlier_contents(database: Database, video_token: str) -> list[Content]:
    """Return what each video shows that comes before this one in its study session."""
    with database.looking_up() as connection:
        rows = connection.execute(ALL, {"token": video_token}).all()
    found: list[Content] = []
    for token, shown in groupby(rows, key=lambda row: row.token):
        if token == video_token:
            break
        found.append(
            tuple(
                Stimulus(condition=each.condition, segment=each.segment, speech=each.speech)
                for each in shown
            )
        )
    return found
