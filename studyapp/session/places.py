"""Places: opening, claiming and giving back. A place is never held by two study sessions."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from functools import cache
from typing import Any, Final

from sqlalchemy import (
    Connection,
    Integer,
    Row,
    Select,
    bindparam,
    exists,
    func,
    literal_column,
    not_,
    select,
    union_all,
    update,
)
from sqlalchemy.orm import Session

from studyapp.database.tables import Place, StudySession
from studyapp.session.intake import (
    Intake,
    current_intake,
    take_allocation_turn,
    wanted_places,
)
from studyapp.session.served_study import ServedStudy

ArmKey = tuple[str, str]
"""An arm's name, and the digest of what its participants are asked."""

RANDOM: Final = random.SystemRandom()

CANDIDATE_PLACES: Final = 16
"""Open places that are looked at together: about as many newcomers are placed at once."""

STALE: Final = StudySession.completed_at.is_(None) & (
    StudySession.last_active_at < bindparam("silent_since")
)
"""That a study session is unfinished and was silent for too long."""

HAS_STALE_PLACE: Final = exists(select(Place.id).join(Place.study_session).where(STALE))

HELD_PLACES: Final = (
    select(Place.arm, Place.design, func.count(Place.study_session_id))
    .where(Place.study_session_id.is_not(None))
    .group_by(Place.arm, Place.design)
)
HELD_BY_ACTIVE_SESSIONS: Final = HELD_PLACES.where(
    Place.study_session_id.in_(select(StudySession.id).where(not_(STALE)))
)


def release_stale_places(session: Session, served: ServedStudy, now: datetime) -> None:
    """Give back the places of unfinished study sessions that have been silent for too long.

    Those are passed over that another transaction is at work on: they are silent no longer. To be
    called in the allocation's turn, so that all newcomers count the same places as held.
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
    """Return an open place of the arm with the fewest held ones, None if all are full.

    Until the transaction ends, nobody else is given it. Places of completed and of active study
    sessions count as held, stale ones are given back before. Among equally filled arms chance
    decides. To be called where the allocation's turn is shared.

    Parameters
    ----------
    wanted : mapping of ArmKey to int
        How many places each arm wants.

    Returns
    -------
    Row or None
        With `id`, `arm`, `design` and `number`.
    """
    arms: dict[str, str | int] = {}
    for index, (arm, design) in enumerate(RANDOM.sample(list(wanted), len(wanted))):
        most = wanted[arm, design]
        arms |= {f"arm{index}": arm, f"design{index}": design, f"wanted{index}": most}
    connection, looks = session.connection(), _place_queries(len(wanted))
    while True:
        # What others are about to get is passed over. They may fail: only a look that waits for
        # them shows that it is gone.
        for look in (looks.skipping, looks.waiting):
            found = connection.execute(look, arms).first()
            if found is not None:
                return found
        if connection.execute(looks.open_ones, arms).first() is None:
            return None


@dataclass(frozen=True, kw_only=True)
class _PlaceQueries:
    """Three looks at the open places that the next newcomers get.

    Attributes
    ----------
    open_ones : Select
        In their order.
    skipping, waiting : Select
        The first one, locked, without those that others have locked, or once these are done.
    """

    open_ones: Select[Any]
    skipping: Select[int, str, str, int]
    waiting: Select[int, str, str, int]


@cache
def _place_queries(arms: int) -> _PlaceQueries:
    """Return how open places of so many arms are looked for.

    The order is that in which newcomers would get the places one after the other: by how many of
    its arm are held once a place is taken. It stays the same while newcomers take places from its
    head, so that those who come at once see it alike, and fill the arms evenly without waiting.
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
    every = union_all(*heads).subquery()
    in_order = (every.c.turn, every.c.chance)
    open_ones = (
        select(every)
        .where(every.c.turn <= every.c.wanted)
        .order_by(*in_order)
        .limit(CANDIDATE_PLACES)
    )
    order = open_ones.subquery()
    foremost = (
        select(Place.id, Place.arm, Place.design, Place.number)
        .join(order, order.c.id == Place.id)
        .where(Place.study_session_id.is_(None))
        .order_by(order.c.turn, order.c.chance)
        .limit(1)
    )
    return _PlaceQueries(
        open_ones=open_ones,
        skipping=foremost.with_for_update(of=Place, skip_locked=True),
        waiting=foremost.with_for_update(of=Place),
    )


def has_open_place(
    reading: Session | Connection, served: ServedStudy, intake: Intake, now: datetime
) -> bool:
    """Tell whether there is a place for a newcomer, as far as can be said outside the turn.

    Places of stale study sessions count as open, though they are given back later.
    """
    wanted = wanted_places(served, intake)

    def has_room(held: Mapping[ArmKey, int]) -> bool:
        return any(held.get(key, 0) < most for key, most in wanted.items())

    since = stale_before(served, now)
    return has_room(_count_held(reading)) or has_room(
        _count_held(reading, HELD_BY_ACTIVE_SESSIONS, {"silent_since": since})
    )


def regain_place(session: Session, served: ServedStudy, study_session: StudySession) -> None:
    """Give a participant back the place that was lost to a pause, if nobody else has it now.

    No other place will do: its trials are other ones. And none where the study has changed
    since, as its pages would no longer fit the trials, or where it wants no more participants.
    """
    ends = (study_session.withdrawn_at, study_session.completed_at, study_session.outcome)
    over = any(end is not None for end in ends)
    key = (study_session.arm, study_session.arm_design)
    if over or study_session.place is not None or key not in served.arms:
        return
    take_allocation_turn(session)
    if _count_held(session).get(key, 0) < wanted_places(served, current_intake(session))[key]:
        own = select(Place).where(
            Place.arm == study_session.arm,
            Place.design == study_session.arm_design,
            Place.number == study_session.number,
            Place.study_session_id.is_(None),
        )
        study_session.place = session.scalars(own).first()
        session.flush()


def stale_before(served: ServedStudy, now: datetime) -> datetime:
    """Return since when somebody unfinished must have been silent to lose the place."""
    return now - timedelta(minutes=served.study.lease_minutes)


def _count_held(
    reading: Session | Connection,
    holders: Select[str, str, int] = HELD_PLACES,
    values: Mapping[str, datetime] | None = None,
) -> dict[ArmKey, int]:
    """Return how many places of each arm are held, by whoever has finished or is active."""
    return {(arm, design): count for arm, design, count in reading.execute(holders, values)}
