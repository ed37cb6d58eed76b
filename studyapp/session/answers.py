"""Answering a trial: all its questions at once, in one transaction."""

from collections.abc import Mapping, Sequence
from typing import Final, cast

from sqlalchemy import Table, insert

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.trial import Response, Trial, Video
from studyapp.session.ending import advance, end_as_unwatched, max_skipped_trials
from studyapp.session.places import regain_place
from studyapp.session.refusal import ConflictError, UnacceptableError
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import (
    find_study_session,
    find_trial,
    load_videos,
    require_current_trial,
    update_row,
)
from studyapp.session.watch_evidence import failed_to_play, missing_seconds
from studyapp.study.design.trial import AnswerKey, Ask
from studyapp.study.design.trial import Trial as AskedTrial
from studyapp.study.settings.presentation import Message
from studyapp.study.settings.study import Study

Fields = Mapping[str, Sequence[str]]
"""A form as it was sent: every value of every name."""

SubmittedAnswers = Mapping[AnswerKey, tuple[int, tuple[str, ...]]]
"""Valid answers to one trial: value and reasons of each."""

RESPONSES: Final = insert(cast(Table, Response.__table__))


def store_answers(
    database: Database,
    served: ServedStudy,
    token: str,
    trial_token: str,
    fields: Fields,
    clock: Clock,
) -> None:
    """Store the answers of the current trial; the last one completes the study session.

    Sending the same answers again changes nothing.

    Parameters
    ----------
    trial_token : str
        The answered trial.
    fields : mapping of field name to texts
        The form as sent: one integer for each `Ask.field`, and names of ticked reasons for each
        `Ask.reasons_field`.

    Raises
    ------
    RefusalError
        If the trial is not theirs, not the current one or already has other answers, an answer is
        missing or invalid, or a video has not been watched. Nothing is changed then.
    """
    study = served.study
    with database.writing() as session:
        study_session = find_study_session(session, token)
        trial = find_trial(study_session, trial_token)
        load_videos(session, [trial])
        submitted = read_answers(study, trial, fields)
        if trial.answered_at is not None:
            _require_same(trial, submitted)
            return
        regain_place(session, served, study_session)
        shown_at = require_current_trial(study_session, trial)
        missing = missing_seconds(trial, study.watching.coverage)
        if missing > 0:
            raise UnacceptableError(
                "About {seconds} s of the videos have not been played yet.",
                "Please play them to the end, with sound and in view; your answers are kept. "
                "If you have done so, switch ad blockers off for this page.",
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
                    "reasons": list(reasons),
                    "answered_at": now,
                }
                for (question, stimulus), (value, reasons) in submitted.items()
            ],
        )
        update_row(session, trial, answered_at=now, seconds=clock.seconds_since(shown_at))
        advance(session, study_session, served.study, now)


def skip_unplayable(
    database: Database,
    served: ServedStudy,
    token: str,
    trial_token: str,
    clock: Clock,
    video_token: str = "",
    media_error: str = "",
) -> None:
    """Skip the current trial because one of its videos does not play.

    After too many of them the study session ends, and its place is released.

    Parameters
    ----------
    video_token : str
        The video; required if the trial shows several.
    media_error : str
        The code of the browser's error with this video; empty if it reports none.

    Raises
    ------
    RefusalError
        If the trial is not theirs or not the current one, the video is not one of its videos, or
        nothing proves that it does not play. Nothing is changed then.
    """
    with database.writing() as session:
        study_session = find_study_session(session, token)
        trial = find_trial(study_session, trial_token)
        if trial.unplayable_at is not None:
            return
        regain_place(session, served, study_session)
        require_current_trial(study_session, trial)
        load_videos(session, [trial])
        video = _find_unplayable_video(trial, video_token)
        if not failed_to_play(video, media_error):
            raise UnacceptableError(
                "There is no sign yet that this video does not play.",
                "Please load it again, press play and wait a few seconds. If it still does not "
                "play, try another browser, device or network with the same link: nothing is lost.",
            )
        now = clock.now()
        video.unplayable_at = now
        trials = study_session.trials
        skipped = sum(each.unplayable_at is not None for each in trials)
        if skipped >= max_skipped_trials(len(trials)):
            end_as_unwatched(session, study_session, now)
        else:
            trial.unplayable_at = now
            advance(session, study_session, served.study, now)


def _find_unplayable_video(trial: Trial, video_token: str) -> Video:
    named = [video for video in trial.videos if video_token in ("", video.token)]
    if len(named) != 1:
        raise UnacceptableError(
            "The page did not say which of its videos does not play.",
            "Please choose the video that does not play.",
        )
    return named[0]


def _require_same(trial: Trial, submitted: SubmittedAnswers) -> None:
    stored = {
        (response.question, response.stimulus): (response.value, tuple(response.reasons))
        for response in trial.responses
    }
    if stored != submitted:
        raise ConflictError(
            "You have already answered this page, and your first answer is stored.",
            "An answer cannot be changed once it is sent. Please go on with the next page.",
        )


def read_answers(study: Study, trial: AskedTrial, fields: Fields) -> SubmittedAnswers:
    """Return the answers in `fields`.

    Raises
    ------
    UnacceptableError
        If one is missing or invalid, or they contradict each other.
    """
    asks = study.asks(trial)
    # A menu or number field left empty is sent too, unless a script keeps the form back.
    sent = {name: values for name, values in fields.items() if list(values) != [""]}
    choices = {ask.field: set(map(str, ask.values)) for ask in asks}
    offered = choices | {ask.reasons_field: set(ask.reasons) for ask in asks}
    for name, values in sent.items():
        is_several = name in choices and len(values) > 1
        if is_several or name not in offered or not set(values) <= offered[name]:
            raise UnacceptableError(
                "An answer is not one of the choices.",
                "Please choose one of the choices for every question.",
            )
    questions = list(dict.fromkeys(ask.question for ask in asks))
    missing = [ask for ask in asks if not sent.get(ask.field)]
    if missing:
        raise UnacceptableError(
            "Questions not answered yet: {numbers}.",
            "Please choose an answer to each; the others you gave are kept.",
            numbers=tuple(_label(ask, 1 + questions.index(ask.question)) for ask in missing),
        )
    stored = {ask.key: int(sent[ask.field][0]) for ask in asks}
    problem = study.problem(trial, stored)
    if problem is not None:
        raise UnacceptableError(
            "{problem}", "Please look at it again; your answers are kept.", problem=problem
        )
    return {
        ask.key: (
            stored[ask.key],
            tuple(name for name in ask.reasons if name in sent.get(ask.reasons_field, ())),
        )
        for ask in asks
    }


def _label(ask: Ask, number: int) -> Message | int:
    """Return the number of the question, with the letter of the video it is about."""
    if ask.stimulus is None:
        return number
    letter = chr(ord("A") + ask.stimulus - 1)
    return Message("{number} about {letter}", number=number, letter=letter)
