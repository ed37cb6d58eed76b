"""Where every study session stands, in one statement and a few rules."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any, Final, Literal, NamedTuple, get_args

from sqlalchemy import Select, func, select
from sqlalchemy.orm import Session

from studyapp.database.tables import Place, StudySession, Trial, Video
from studyapp.researchers.exclusion_decisions import standing_exclusions
from studyapp.session.served_study import ServedStudy
from studyapp.session.state import state_of

Standing = Literal["done", "replaced", "active", "stale", "unwatched", "lapsed", "withdrawn"]
STANDINGS: Final[tuple[Standing, ...]] = get_args(Standing)


class _Row(NamedTuple):
    """What the database says of one study session."""

    id: int
    arm: str
    arm_design: str
    consented_at: datetime
    started_at: datetime | None
    last_active_at: datetime
    completed_at: datetime | None
    withdrawn_at: datetime | None
    outcome: str | None
    place: int | None
    excluded: bool
    trials: int
    settled: int
    left_out: int


@dataclass(frozen=True, kw_only=True)
class Sitting:
    """One study session, as far as its progress goes.

    Attributes
    ----------
    id : int
        Its number, which says nothing of whose it is.
    arm : str
    present : bool
        Whether its arm is one of the study as it is served; others are of earlier versions.
    standing : Standing
        ``done`` has finished; ``replaced`` has, and the place was given to somebody else after
        failed checks; ``active`` and ``stale`` hold a place, the latter silently for so long that
        the next newcomer may get it; ``unwatched`` was ended, since too many videos were said not
        to play; ``lapsed`` has lost its place; ``withdrawn`` took consent back.
    trials, settled : int
        Trials planned, and those answered or said not to play. None are left of who withdrew.
    left_out : int
        Pages on which a video was said not to play, that which ended the study session included.
    excluded : bool
        Whether a researcher leaves it out of the analysis.
    """

    id: int
    arm: str
    present: bool
    standing: Standing
    consented_at: datetime
    started_at: datetime | None
    last_active_at: datetime
    completed_at: datetime | None
    trials: int
    settled: int
    left_out: int = 0
    excluded: bool = False


def sittings(
    session: Session, served: ServedStudy, now: datetime, *, only: int | None = None
) -> list[Sitting]:
    """Return every study session, the first one first; or `only` that of one number."""
    silent_since = now - timedelta(minutes=served.study.lease_minutes)
    rows = [_Row(*row) for row in session.connection().execute(_query(only)).all()]
    return [
        Sitting(
            id=row.id,
            arm=row.arm,
            present=(row.arm, row.arm_design) in served.arms,
            standing=_standing(row, silent_since),
            consented_at=row.consented_at,
            started_at=row.started_at,
            last_active_at=row.last_active_at,
            completed_at=row.completed_at,
            trials=row.trials,
            settled=row.settled,
            left_out=row.left_out,
            excluded=row.excluded,
        )
        for row in rows
    ]


def present_ones(all_of_them: Sequence[Sitting]) -> list[Sitting]:
    """Return those of the study as it is served."""
    return [sitting for sitting in all_of_them if sitting.present]


def _standing(row: _Row, silent_since: datetime) -> Standing:
    state = state_of(row)
    if state == "completed":
        return "replaced" if row.place is None else "done"
    if state in ("withdrawn", "unwatched", "lapsed"):
        return state
    return "stale" if row.last_active_at < silent_since else "active"


def _query(only: int | None) -> Select[*tuple[Any, ...]]:
    """Select the rows of all study sessions, or of `only` one."""
    planned = select(
        Trial.study_session_id.label("owner"),
        func.count().label("trials"),
        (func.count(Trial.answered_at) + func.count(Trial.unplayable_at)).label("settled"),
    ).group_by(Trial.study_session_id)
    if only is not None:
        planned = planned.where(Trial.study_session_id == only)
    of_trials = planned.subquery()
    failing = select(Trial.study_session_id.label("owner"), func.count().label("left_out"))
    failing = failing.join(Video, Video.trial_id == Trial.id)
    failing = failing.where(Video.unplayable_at.is_not(None)).group_by(Trial.study_session_id)
    of_videos = failing.subquery()
    by_hand = standing_exclusions().subquery()
    query = (
        select(
            StudySession.id,
            StudySession.arm,
            StudySession.arm_design,
            StudySession.consented_at,
            StudySession.started_at,
            StudySession.last_active_at,
            StudySession.completed_at,
            StudySession.withdrawn_at,
            StudySession.outcome,
            Place.id,
            by_hand.c.study_session_id.is_not(None),
            func.coalesce(of_trials.c.trials, 0),
            func.coalesce(of_trials.c.settled, 0),
            func.coalesce(of_videos.c.left_out, 0),
        )
        .outerjoin(of_trials, of_trials.c.owner == StudySession.id)
        .outerjoin(of_videos, of_videos.c.owner == StudySession.id)
        .outerjoin(Place, Place.study_session_id == StudySession.id)
        .outerjoin(by_hand, by_hand.c.study_session_id == StudySession.id)
        .order_by(StudySession.id)
    )
    return query if only is None else query.where(StudySession.id == only)
