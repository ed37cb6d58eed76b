"""The rows of exported tables: answers, participants, how they watched, and what was refused.

They hold no token and no name. Cells stand under the headings that `columns.toml` declares; of what
is read here and has no heading there, nothing is exported.
"""

from collections.abc import Iterator

import pandas as pd
from sqlalchemy import or_, select
from sqlalchemy.orm import Session, selectinload

from studyapp.database.tables.study_session import FormAnswer, RefusalLine, StudySession
from studyapp.database.tables.trial import Trial, Video
from studyapp.results.analysed_tasks import sides
from studyapp.results.export.columns import REFUSALS, WATCHING
from studyapp.results.stored_answers import StoredAnswers, select_sessions
from studyapp.session.watch_evidence import NOTHING_PLAYED, watched_seconds


def answers_table(stored: StoredAnswers) -> pd.DataFrame:
    """Return every stored answer, one row per answered question and stimulus.

    Answers of all kinds of trial and of unfinished study sessions are included.

    Of a trial that shows two stimuli, `left_…` and `right_…` say what was A and B, and
    `comparison` names the pair: `reference` is the one the study puts first. Of a catch trial,
    `other` is the visibly flawed condition and `reference` the one it is shown beside. These
    columns are empty for other trials. An answer about one stimulus names it in `stimulus` (its
    number), `condition` and `speech`, which are empty for answers about the whole trial. The
    `reasons` ticked for an order stand beside each of its ranks.

    Parameters
    ----------
    stored : StoredAnswers
        In full.

    Returns
    -------
    DataFrame
        Ordered by study session, position and answer.
    """
    own = stored.study_sessions[["study_session", "version", "arm", "conditions"]]
    trials = stored.trials.merge(own, on="study_session")
    pairs = _pairs(trials.merge(sides(stored.stimuli), on="trial"))
    about = stored.stimuli.rename(columns={"number": "stimulus"}).drop(columns="segment")
    rows = stored.answers.merge(trials, on="trial").merge(pairs, on="trial", how="left")
    rows = rows.merge(about, on=["trial", "stimulus"], how="left")
    numbers = rows["expected"].astype("Int64").astype("string")
    return rows.assign(
        stimulus=rows["stimulus"].replace(0, None),
        expected=rows["side"].where(rows["side"].notna(), numbers),
        reasons=[" ".join(reasons) for reasons in rows["reasons"]],
    )


def _pairs(trials: pd.DataFrame) -> pd.DataFrame:
    """Return the columns about a pair, one row for each trial that shows one."""
    columns = ["trial", "left_condition", "right_condition", "left_speech", "right_speech"]
    named = trials.rename(
        columns={
            f"{what}_{side}": f"{side}_{what}"
            for what in ("condition", "speech")
            for side in ("left", "right")
        }
    )
    order = list(_in_order(trials))
    return named[columns].assign(
        comparison=[
            arm if len(conditions) == 2 else "-".join(pair)
            for arm, conditions, pair in zip(
                trials["arm"], trials["conditions"], order, strict=True
            )
        ],
        reference=[reference for reference, _ in order],
        other=[other for _, other in order],
        side=trials["expected"].map({1.0: "left", 2.0: "right"}),
    )


def _in_order(trials: pd.DataFrame) -> Iterator[tuple[str, str]]:
    """Yield the two conditions of each trial, the reference first."""
    for left, right, expected, conditions in zip(
        *(trials[name] for name in ("condition_left", "condition_right", "expected", "conditions")),
        strict=True,
    ):
        if pd.isna(expected):
            reference, other = sorted((left, right), key=conditions.index)
        else:
            reference, other = (left, right) if expected == 1 else (right, left)
        yield reference, other


def participants_table(stored: StoredAnswers) -> pd.DataFrame:
    """Return every study session and where it stands, for the participant flow.

    `state` is ``instructed``, ``started``, ``completed``, ``unwatched``, ``withdrawn`` or
    ``lapsed`` (silent for so long that the place was given back).
    """
    found = stored.study_sessions
    return found.rename(columns={"trials": "presentations"}).assign(
        answered=found["settled"] - found["unplayable"]
    )


def form_answers_table(session: Session, *, withdrawn: bool = False) -> pd.DataFrame:
    """Return what participants said about themselves, one row per answered question.

    Who withdrew is left out. With `withdrawn`, nobody else is in it.
    """
    columns = (FormAnswer.study_session_id, FormAnswer.stage, FormAnswer.question, FormAnswer.value)
    query = select(*columns).join(FormAnswer.study_session).where(select_sessions(withdrawn))
    rows = session.execute(query.order_by(FormAnswer.study_session_id, FormAnswer.id)).all()
    return pd.DataFrame(rows, columns=["study_session", "stage", "question", "value"])


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
    watched = watched_seconds(video.sent_at, record.intervals)
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
