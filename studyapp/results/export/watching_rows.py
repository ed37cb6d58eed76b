"""Export of the watch evidence and of refusals, as tables that hold no token and no name."""

from __future__ import annotations

import pandas as pd
from sqlalchemy import or_, select
from sqlalchemy.orm import Session, selectinload

from studyapp.database.tables import RefusalLine, StudySession, Trial, Video
from studyapp.results.export.columns import REFUSALS, WATCHING
from studyapp.session.videos.watch_evidence import NOTHING_PLAYED, length, watched_so_far


def watching_table(session: Session) -> pd.DataFrame:
    """Return how each video was watched, one row per video of each trial that was shown.

    Trials of all kinds and of unfinished study sessions are included; those of participants who
    withdrew are not.

    Returns
    -------
    DataFrame
        Columns of `WATCHING`, ordered by study session, position and video. `video` is 0 for the
        reference; `stimuli` and `conditions` say what it shows, from left to right.
        `watched` is the share that counts as watched, in [0, 1]; `sent_at` is when the video was
        first sent, empty where it never was, and then nothing counts; `times_played` the seconds
        played in any way, replays included, over the duration. `rate` is the largest seen. Of
        `frames` pictures the browser left out `dropped_share`; both are empty where it does not
        count them. `unplayable_at` is when the participant said that it does not play, ISO 8601
        in UTC, else empty.
    """
    query = (
        select(Trial)
        .join(Trial.study_session)
        .where(
            StudySession.withdrawn_at.is_(None),
            or_(Trial.shown_at.is_not(None), Trial.unplayable_at.is_not(None)),
        )
        .order_by(Trial.study_session_id, Trial.position)
        .options(
            selectinload(Trial.study_session).selectinload(StudySession.version),
            selectinload(Trial.videos).selectinload(Video.watch_record),
            selectinload(Trial.videos).selectinload(Video.stimuli),
        )
    )
    rows = [
        {
            "study_session": trial.study_session_id,
            "version": trial.study_session.version.number,
            "arm": trial.study_session.arm,
            "part": trial.part,
            "position": trial.position,
            "kind": trial.kind,
            "segment": trial.segment,
            **_of_video(video),
        }
        for trial in session.scalars(query)
        for video in trial.videos
    ]
    return pd.DataFrame(rows, columns=list(WATCHING.names[1:]))


def _of_video(video: Video) -> dict[str, object]:
    record = video.watch_record or NOTHING_PLAYED
    watched = length(watched_so_far(video, 0.0).intervals)
    frames, dropped = record.frames, record.dropped_frames
    return {
        "video": video.number,
        "stimuli": " ".join(str(shown.number) for shown in video.stimuli),
        "conditions": " ".join(shown.condition for shown in video.stimuli),
        "made_from": video.made_from,
        "duration": video.duration,
        "watched": round(min(1.0, watched / video.duration), 4),
        "sent_at": video.sent_at,
        "times_played": round(record.played_seconds / video.duration, 2),
        "rate": round(record.rate or 1.0, 3),
        "hidden_seconds": round(record.hidden_seconds, 2),
        "silent_seconds": round(record.silent_seconds, 2),
        "stalls": record.stalls,
        "stalled_seconds": round(record.stalled_seconds, 2),
        "frames": frames,
        "dropped_share": round(dropped / frames, 4) if frames and dropped is not None else None,
        "unplayable_at": video.unplayable_at,
    }


def refusals_table(session: Session) -> pd.DataFrame:
    """Return the requests that were refused, one row each, the first one first.

    Returns
    -------
    DataFrame
        Columns of `REFUSALS`; `study_session` is empty where the address belonged to nobody.
        Who withdrew is left out.
    """
    query = (
        select(
            RefusalLine.study_session_id,
            RefusalLine.at,
            RefusalLine.kind,
            RefusalLine.detail,
        )
        .outerjoin(StudySession, StudySession.id == RefusalLine.study_session_id)
        .where(StudySession.withdrawn_at.is_(None))
        .order_by(RefusalLine.id)
    )
    rows = session.execute(query).all()
    return pd.DataFrame(rows, columns=list(REFUSALS.names[1:]), dtype=object)
