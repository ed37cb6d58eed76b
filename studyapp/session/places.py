"""Places: taking, releasing and regaining them. No place is ever held by two study sessions."""

import random
from collections.abc import Mapping
from datetime import datetime, timedelta
from functools import cache
from typing import Any, Final

from sqlalchemy import (
    Integer,
    Row,
    Select,
    bindparam,
    func,
    literal_column,
    not_,
    select,
    union_all,
    update,
)
from sqlalchemy.orm import Session

from studyapp.database.tables.study_session import IntakeChange, Place, StudySession
from studyapp.session.intake import current_intake, take_allocation_turn, wanted_places
from studyapp.session.refusal import StudyFullError
from studyapp.session.served_study import ServedStudy

ArmKey = tuple[str, str]
"""An arm's name, and the digest of its design."""

RANDOM: Final = random.SystemRandom()

CANDIDATE_PLACES: Final = 16
"""Open places that one query considers: about as many newcomers can be placed at once."""

STALE: Final = StudySession.completed_at.is_(None) & (
    StudySession.last_active_at < bindparam("silent_since")
)
"""An unfinished study session that has been inactive for too long."""

HELD_PLACES: Final = (
    select(Place.arm, Place.design, func.count(Place.study_session_id))
    .where(Place.study_session_id.is_not(None))
    .group_by(Place.arm, Place.design)
)
HELD_BY_ACTIVE_SESSIONS: Final = HELD_PLACES.where(
    Place.study_session_id.in_(select(StudySession.id).where(not_(STALE)))
)


def has_stale_places(session: Session, served: ServedStudy, now: datetime) -> bool:
    """Tell whether somebody holds a place who has been inactive for too long."""
    stale = select(Place.id).join(Place.study_session).where(STALE).limit(1)
    return session.scalar(stale, {"silent_since": stale_before(served, now)}) is not None


def release_stale_places(session: Session, served: ServedStudy, now: datetime) -> None:
    """Release the places of unfinished study sessions that have been inactive for too long.

    Study sessions locked by another transaction are active again and skipped. The caller must have
    the allocation's turn, so that all newcomers count the same places as held.
    """
    stale = session.scalars(
        select(StudySession.id)
        .join(StudySession.place)
        .where(STALE)
        .with_for_update(of=StudySession, skip_locked=True),
        {"silent_since": stale_before(served, now)},
    ).all()
    session.execute(
        update(Place).where(Place.study_session_id.in_(stale)).values(study_session_id=None)
    )


def take_open_place(
    session: Session, wanted: Mapping[ArmKey, int]
) -> Row[int, str, str, int] | None:
    """Lock and return an open place of the arm with the fewest held places; None if all are full.

    Places of completed and active study sessions count as held; stale ones must have been released
    before. Ties between arms are broken at random. The caller must share the allocation's turn.

    Parameters
    ----------
    wanted : mapping of ArmKey to int
        Number of places of each arm.

    Returns
    -------
    Row or None
        With `id`, `arm`, `design` and `number`.
    """
    parameters: dict[str, str | int] = {}
    for index, (arm, design) in enumerate(RANDOM.sample(list(wanted), len(wanted))):
        count = wanted[arm, design]
        parameters |= {f"arm{index}": arm, f"design{index}": design, f"wanted{index}": count}
    connection = session.connection()
    open_places, skipping, waiting = _place_queries(len(wanted))
    while True:
        # Skip places that others have locked; if none is left, wait, as the others may fail.
        for query in (skipping, waiting):
            place = connection.execute(query, parameters).first()
            if place is not None:
                return place
        if connection.execute(open_places, parameters).first() is None:
            return None


@cache
def _place_queries(
    arms: int,
) -> tuple[Select[Any], Select[int, str, str, int], Select[int, str, str, int]]:
    """Return three queries for open places of so many arms.

    All of them that the next newcomers get; and the first, locked, skipping places that others have
    locked, or waiting for them.

    Places are in the order in which successive newcomers would get them: by how many places of the
    arm are then held. Taking places from the head does not change the order, so simultaneous
    newcomers see the same one, and fill the arms evenly without waiting.
    """
    heads = []
    for index in range(arms):
        of_arm = (Place.arm == bindparam(f"arm{index}")) & (
            Place.design == bindparam(f"design{index}")
        )
        held = select(func.count(Place.study_session_id)).where(of_arm).scalar_subquery()
        is_open = Place.study_session_id.is_(None)
        head = select(Place.id, Place.number).where(of_arm, is_open)
        first = head.order_by(Place.number).limit(CANDIDATE_PLACES).subquery()
        turn = held + func.row_number().over(order_by=first.c.number)
        heads.append(
            select(
                first.c.id,
                turn.label("turn"),
                literal_column(str(index)).label("chance"),
                bindparam(f"wanted{index}", type_=Integer).label("wanted"),
            )
        )
    candidates = union_all(*heads).subquery()
    open_places = (
        select(candidates)
        .where(candidates.c.turn <= candidates.c.wanted)
        .order_by(candidates.c.turn, candidates.c.chance)
        .limit(CANDIDATE_PLACES)
    )
    ordered = open_places.subquery()
    foremost = (
        select(Place.id, Place.arm, Place.design, Place.number)
        .join(ordered, ordered.c.id == Place.id)
        .where(Place.study_session_id.is_(None))
        .order_by(ordered.c.turn, ordered.c.chance)
        .limit(1)
    )
    return (
        open_places,
        foremost.with_for_update(of=Place, skip_locked=True),
        foremost.with_for_update(of=Place),
    )


def has_open_place(
    session: Session, served: ServedStudy, intake: IntakeChange, now: datetime
) -> bool:
    """Tell whether a place is open for a newcomer; outside the turn, this can change any moment.

    Places of stale study sessions count as open, though they are released later.
    """
    wanted = wanted_places(served, intake)

    def has_room(held: Mapping[ArmKey, int]) -> bool:
        return any(held.get(key, 0) < count for key, count in wanted.items())

    since = stale_before(served, now)
    return has_room(_count_held(session)) or has_room(
        _count_held(session, HELD_BY_ACTIVE_SESSIONS, {"silent_since": since})
    )


def require_open_place(
    session: Session, served: ServedStudy, intake: IntakeChange, now: datetime
) -> None:
    """Raise `StudyFullError` unless newcomers are admitted and a place is open."""
    require_open_intake(served, intake)
    if not has_open_place(session, served, intake, now):
        raise full_study_error()


def require_open_intake(served: ServedStudy, intake: IntakeChange) -> None:
    """Raise `StudyFullError` unless newcomers are admitted, whether or not a place is open."""
    if intake.state == "closed":
        raise StudyFullError(
            "The study is over: it takes no more participants.",
            "Thank you for your interest.",
        )
    if intake.state == "paused":
        raise StudyFullError(
            "The study is paused at the moment.",
            "Thank you for your interest. Please come back later: the same link works then.",
        )
    if not served.study.open:
        raise StudyFullError(
            "The study takes no new participants at the moment.",
            "Thank you for your interest. You can try later with the same link.",
        )


def full_study_error() -> StudyFullError:
    """Return the refusal of newcomers while all places are held."""
    return StudyFullError(
        "The study has all the participants it needs at the moment.",
        "Thank you for your interest. A place may open again: you can try later with the "
        "same link.",
    )


def regain_place(session: Session, served: ServedStudy, study_session: StudySession) -> None:
    """Give an inactive participant the lost place back, if it is still open and needed.

    Other places have other trials. If the study has changed, its pages no longer fit the trials.
    """
    ends = (study_session.withdrawn_at, study_session.completed_at, study_session.outcome)
    is_over = any(end is not None for end in ends)
    key = (study_session.arm, study_session.arm_design)
    if is_over or study_session.place is not None or key not in served.arms:
        return
    take_allocation_turn(session)
    if _count_held(session).get(key, 0) < wanted_places(served, current_intake(session))[key]:
        lost = select(Place).where(
            Place.arm == study_session.arm,
            Place.design == study_session.arm_design,
            Place.number == study_session.number,
            Place.study_session_id.is_(None),
        )
        study_session.place = session.scalars(lost).first()
        session.flush()


def stale_before(served: ServedStudy, now: datetime) -> datetime:
    """Return the time of the last activity before which a place is lost."""
    return now - timedelta(minutes=served.study.lease_minutes)


def _count_held(
    session: Session,
    holders: Select[str, str, int] = HELD_PLACES,
    values: Mapping[str, datetime] | None = None,
) -> dict[ArmKey, int]:
    """Return the number of held places of each arm."""
    return {(arm, design): count for arm, design, count in session.execute(holders, values)}
