"""A study session's rows, and its state.

Related rows are loaded in few statements, as each costs a round trip. Relations that nobody loaded
load themselves; that is slower, not wrong.
"""

from collections.abc import Mapping, Sequence
from datetime import datetime
from functools import cache
from typing import Any, Final, Literal, cast

from sqlalchemy import Row, Table, Update, bindparam, select, update
from sqlalchemy.orm import Session, joinedload
from sqlalchemy.orm.attributes import set_committed_value

from studyapp.database.tables.study_session import Place, StudySession
from studyapp.database.tables.trial import Trial, Video
from studyapp.session.refusal import ConflictError, NotTheirsError, UnknownAddressError
from studyapp.study.settings.questions import Stage
from studyapp.study.settings.study import Study

State = Literal["instructed", "started", "completed", "unwatched", "withdrawn", "lapsed"]


def find_study_session(session: Session, token: str, *, to_change: bool = True) -> StudySession:
    """Return the study session with this token, by default locked.

    Its trials and place are loaded after it: loaded with it, they would be those from before the
    wait for the lock.

    Raises
    ------
    UnknownAddressError
        If there is none.
    """
    query = select(StudySession).where(StudySession.token == token)
    study_session = session.scalars(query.with_for_update() if to_change else query).first()
    if study_session is None:
        raise UnknownAddressError(
            "This address belongs to no participant of this study.",
            "Please open the link you were given once more.",
        )
    parameters = {"id": study_session.id}
    place = session.scalars(PLACE, parameters).one_or_none()
    set_committed_value(study_session, "place", place)
    set_committed_value(study_session, "trials", list(session.scalars(TRIALS, parameters)))
    return study_session


def state_of(study_session: StudySession | Row[*tuple[Any, ...]]) -> State:
    """Return the state of `study_session`, or of a row of the columns that decide about it.

    ``instructed`` has consented but not begun, ``unwatched`` ended because too many videos did not
    play, ``lapsed`` was inactive for so long that its place was released.
    """
    if study_session.withdrawn_at is not None:
        return "withdrawn"
    if study_session.completed_at is not None:
        return "completed"
    if study_session.outcome is not None:
        return "unwatched"
    if study_session.place is None:
        return "lapsed"
    return "instructed" if study_session.started_at is None else "started"


def current_trial(study_session: StudySession) -> Trial | None:
    """Return the trial to be shown; None if none is left."""
    return next((trial for trial in study_session.trials if not trial.settled), None)


def form_due(study_session: StudySession, study: Study) -> Stage | None:
    """Return the stage whose questions about the participant must be answered now; or None."""
    if study_session.started_at is None:
        stage: Stage = "demographics"
    elif current_trial(study_session) is None:
        stage = "closing"
    else:
        return None
    answered = {answer.question for answer in study_session.form_answers}
    asked = {question.name for question in study.form.questions_at(stage)}
    return stage if asked - answered else None


def has_tried_comprehension(study_session: StudySession) -> bool:
    """Tell whether the questions about the instructions were answered wrongly once."""
    return any(answer.stage == "comprehension" for answer in study_session.form_answers)


def require_current_trial(study_session: StudySession, trial: Trial) -> datetime:
    """Return when `trial` was first shown; `ConflictError` unless it is the current one."""
    is_current = state_of(study_session) == "started" and trial is current_trial(study_session)
    if not is_current or trial.shown_at is None:
        raise wrong_page_error()
    return trial.shown_at


def wrong_page_error() -> ConflictError:
    """Return the refusal of what belongs to another page than the present one."""
    return ConflictError(
        "This is not the page you are on.",
        "Perhaps the study is open in two windows. The next page shows how to go on; nothing is "
        "lost.",
    )


def find_trial(study_session: StudySession, trial_token: str) -> Trial:
    """Return the study session's trial with this token, or raise `NotTheirsError`."""
    for trial in study_session.trials:
        if trial.token == trial_token:
            return trial
    raise _not_theirs_error()


def find_video(session: Session, study_session: StudySession, video_token: str) -> Video:
    """Return the study session's video with this token, with all videos of its trial loaded.

    Raises
    ------
    NotTheirsError
        If the video belongs to nobody or to somebody else.
    """
    videos = session.scalars(VIDEOS_BESIDE, {"token": video_token}).unique().all()
    trial = next((t for t in study_session.trials if videos and t.id == videos[0].trial_id), None)
    if trial is None:
        raise _not_theirs_error()
    _attach(trial, videos)
    return next(video for video in videos if video.token == video_token)


def _not_theirs_error() -> NotTheirsError:
    return NotTheirsError(
        "This page does not belong to you.",
        "Go on with your own; nothing you answered is lost.",
    )


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


def load_videos(session: Session, trials: Sequence[Trial]) -> None:
    """Load the videos of `trials` with their stimuli and watch records."""
    parameters = {"trials": [trial.id for trial in trials]}
    videos = session.scalars(VIDEOS_OF_TRIALS, parameters).unique().all()
    for trial in trials:
        _attach(trial, [video for video in videos if video.trial_id == trial.id])


def durations_of(session: Session, study_session: StudySession) -> Mapping[int, Sequence[float]]:
    """Return the durations of the videos of every trial in seconds, by the trial's `id`."""
    durations: dict[int, list[float]] = {trial.id: [] for trial in study_session.trials}
    for trial_id, duration in session.execute(DURATIONS, {"id": study_session.id}):
        durations[trial_id].append(duration)
    return durations


def _attach(trial: Trial, videos: Sequence[Video]) -> None:
    stimuli = [stimulus for video in videos for stimulus in video.stimuli]
    set_committed_value(trial, "videos", list(videos))
    set_committed_value(trial, "stimuli", sorted(stimuli, key=lambda stimulus: stimulus.number))


ROW = "the_row"


def update_row(session: Session, row: StudySession | Trial, **values: object) -> None:
    """Store `values` in the columns of `row`, in the database and in the object."""
    table = cast(Table, type(row).__table__)
    session.connection().execute(_update_of(table, tuple(values)), {ROW: row.id, **values})
    for name, value in values.items():
        set_committed_value(row, name, value)


@cache
def _update_of(table: Table, names: tuple[str, ...]) -> Update:
    values: dict[str, Any] = {name: bindparam(name) for name in names}
    return update(table).where(table.c.id == bindparam(ROW)).values(values)
