"""Loading what belongs to a study session in few statements: each costs as much as a page's words.

The relations load themselves where these functions were not called; that is slower, not wrong.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import Any, Final, cast

from sqlalchemy import Table, Update, bindparam, select, update
from sqlalchemy.orm import Session, joinedload
from sqlalchemy.orm.attributes import set_committed_value

from studyapp.database.tables import Place, StudySession, Trial, Video

PLACE: Final = select(Place).where(Place.study_session_id == bindparam("id"))
TRIALS: Final = (
    select(Trial).where(Trial.study_session_id == bindparam("id")).order_by(Trial.position)
)

VIDEOS: Final = (
    select(Video)
    .order_by(Video.number)
    .options(joinedload(Video.stimuli, innerjoin=True), joinedload(Video.watch_record))
)
VIDEOS_OF_TRIALS: Final = VIDEOS.where(Video.trial_id.in_(bindparam("trials", expanding=True)))
VIDEOS_BESIDE: Final = VIDEOS.where(
    Video.trial_id
    == select(Video.trial_id).where(Video.token == bindparam("token")).scalar_subquery()
)
DURATIONS: Final = (
    select(Video.trial_id, Video.duration)
    .join(Video.trial)
    .where(Trial.study_session_id == bindparam("id"))
)


def load_place_and_trials(session: Session, study_session: StudySession) -> None:
    """Load the place and the trials of `study_session`."""
    own = {"id": study_session.id}
    set_committed_value(study_session, "place", session.scalars(PLACE, own).one_or_none())
    set_committed_value(study_session, "trials", list(session.scalars(TRIALS, own)))


def load_videos(session: Session, trials: Iterable[Trial]) -> None:
    """Load the videos of `trials`, what they show, and what was played of them."""
    wanted = {trial.id: trial for trial in trials}
    videos = session.scalars(VIDEOS_OF_TRIALS, {"trials": list(wanted)}).unique().all()
    for number, trial in wanted.items():
        _attach(trial, [video for video in videos if video.trial_id == number])


def durations_of(session: Session, study_session: StudySession) -> Mapping[int, Sequence[float]]:
    """Return how long the videos of every trial are, in seconds, by the trial's `id`."""
    durations: dict[int, list[float]] = {trial.id: [] for trial in study_session.trials}
    for trial_id, duration in session.execute(DURATIONS, {"id": study_session.id}):
        durations[trial_id].append(duration)
    return durations


def load_video(session: Session, study_session: StudySession, token: str) -> Video | None:
    """Return the video of `study_session` that `token` names, its trial's videos loaded with it.

    Returns
    -------
    Video or None
        None where it is none of this study session.
    """
    videos = session.scalars(VIDEOS_BESIDE, {"token": token}).unique().all()
    trial = next((t for t in study_session.trials if videos and t.id == videos[0].trial_id), None)
    if trial is None:
        return None
    _attach(trial, videos)
    return next(video for video in videos if video.token == token)


def _attach(trial: Trial, videos: Sequence[Video]) -> None:
    shown = [stimulus for video in videos for stimulus in video.stimuli]
    set_committed_value(trial, "videos", list(videos))
    set_committed_value(trial, "stimuli", sorted(shown, key=lambda found: found.number))


ROW = "the_row"


def note(session: Session, row: StudySession | Trial, **values: object) -> None:
    """Store `values` in the columns of the stored `row`; `row` has them afterwards."""
    table = cast(Table, type(row).__table__)
    session.connection().execute(_noting(table, tuple(values)), {ROW: row.id, **values})
    for name, value in values.items():
        set_committed_value(row, name, value)


@cache
def _noting(table: Table, names: tuple[str, ...]) -> Update:
    values: dict[str, Any] = {name: bindparam(name) for name in names}
    return update(table).where(table.c.id == bindparam(ROW)).values(values)
