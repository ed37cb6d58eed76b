"""Answering a trial: all its questions at once, stored before anything else happens."""

from __future__ import annotations

from typing import Final, cast

from sqlalchemy import Table, insert

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import Response, Trial, Video
from studyapp.session.answer_fields import Fields, Given, read_fields
from studyapp.session.arrival.places import regain_place
from studyapp.session.completion import end_unwatched, most_left_out, move_on
from studyapp.session.refusal import ConflictError, UnacceptableError
from studyapp.session.rows import load_videos, note
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import find, require_present, trial_of
from studyapp.session.videos.watch_evidence import failed_to_play, missing_seconds

RESPONSES: Final = insert(cast(Table, Response.__table__))


def answer(
    database: Database,
    served: ServedStudy,
    token: str,
    trial_token: str,
    fields: Fields,
    clock: Clock,
) -> None:
    """Store the answers of the present trial; with the last one comes the completion code.

    The same answers sent again change nothing and are no error.

    Parameters
    ----------
    trial_token : str
        The trial that was answered.
    fields : mapping of field name to texts
        As the form sent them: one whole number for each `Ask.field` of the trial, and the
        names of any reasons ticked under their `Ask.reasons_field`.

    Raises
    ------
    RefusalError
        If the trial is not theirs, not the present one or answered differently before, an
        answer is missing, unknown or out of range, or a video is not yet watched. Nothing is
        changed then.
    """
    study = served.study
    with database.writing() as session:
        study_session = find(session, token)
        trial = trial_of(study_session, trial_token)
        load_videos(session, [trial])
        given = read_fields(study, trial, fields)
        if trial.answered_at is not None:
            _require_same(trial, given)
            return
        regain_place(session, served, study_session)
        shown_at = require_present(study_session, trial)
        missing = missing_seconds(trial, study.watching.coverage)
        if missing > 0:
            raise UnacceptableError(
                "About {seconds} s of the videos have not been played yet.",
                "Please play them to the end, with sound and in view; your answers are kept.",
                seconds=max(1, round(missing)),
            )
        now = clock.now()
        session.connection().execute(
            RESPONSES,
            [
                {
                    "trial_id": trial.id,
                    "question": question,
                    "stimulus": stimulus,
                    "value": value,
                    "reasons": list(given.reasons.get((question, stimulus), ())),
                    "answered_at": now,
                }
                for (question, stimulus), value in given.values.items()
            ],
        )
        note(session, trial, answered_at=now, seconds=clock.seconds_since(shown_at))
        move_on(session, study_session, served.study, now)


def skip_unplayable(
    database: Database,
    served: ServedStudy,
    token: str,
    trial_token: str,
    clock: Clock,
    video_token: str = "",
    media_error: str = "",
) -> None:
    """Record that a video of the present trial does not play, and go on without an answer.

    After too many of them the study session ends, and its place is given to somebody else.

    Parameters
    ----------
    video_token : str
        The video; needed where the trial shows several.
    media_error : str
        The code of the browser's error with this video; empty where it reports none.

    Raises
    ------
    RefusalError
        If the trial is not theirs or not the present one, the video is none of its own, or
        nothing shows that it does not play. Nothing is changed then.
    """
    with database.writing() as session:
        study_session = find(session, token)
        trial = trial_of(study_session, trial_token)
        if trial.unplayable_at is not None:
            return
        regain_place(session, served, study_session)
        require_present(study_session, trial)
        load_videos(session, [trial])
        video = _unplayable(trial, video_token)
        if not failed_to_play(video, media_error):
            raise UnacceptableError(
                "There is no sign yet that this video does not play.",
                "Please load it again, press play and wait a few seconds. If it still does not "
                "play, try another browser, device or network with the same link: nothing is lost.",
            )
        now = clock.now()
        video.unplayable_at = now
        if sum(each.unplayable_at is not None for each in study_session.trials) >= most_left_out(
            len(study_session.trials)
        ):
            end_unwatched(session, study_session, now)
        else:
            trial.unplayable_at = now
            move_on(session, study_session, served.study, now)


def _unplayable(trial: Trial, video_token: str) -> Video:
    named = [video for video in trial.videos if video_token in ("", video.token)]
    if len(named) != 1:
        raise UnacceptableError(
            "The page did not say which of its videos does not play.",
            "Please choose the video that does not play.",
        )
    return named[0]


def _require_same(trial: Trial, given: Given) -> None:
    stored = {
        (response.question, response.stimulus): (response.value, tuple(response.reasons))
        for response in trial.responses
    }
    if stored != given.stored():
        raise ConflictError(
            "You have already answered this page, and your first answer is stored.",
            "An answer cannot be changed once it is sent. Please go on with the next page.",
        )
