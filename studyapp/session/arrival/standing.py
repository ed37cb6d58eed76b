"""How things stand for somebody who arrives, in one statement: each costs processor time."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any, Final

from sqlalchemy import Connection, Select, bindparam, false, select
from sqlalchemy.orm import InstrumentedAttribute

from studyapp.database.tables import StudySession, StudyVersion
from studyapp.session.arrival.intake import NEWEST_MORE_PLACES, NEWEST_STATE, Intake, intake_of
from studyapp.session.arrival.newcomers import ARE_ANY_OLD, CAME_FROM_ADDRESS, WINDOW
from studyapp.session.arrival.places import IS_ANY_STALE, silent_since
from studyapp.session.served_study import ServedStudy


@dataclass(frozen=True, kw_only=True)
class Standing:
    """How things stand for somebody who arrives.

    Attributes
    ----------
    study_session_id : int or None
        The study session that they have already.
    intake : Intake
        What researchers have decided.
    came_from_address : int
        Newcomers from their network address within an hour.
    version_id : int or None
        The version that is served; None where it is not the database's any more.
    is_any_stale, are_any_old : bool
        Whether a place is held by somebody who has been silent for too long, and newcomers are
        noted who came longer than an hour ago; False outside the allocation's turn.
    """

    study_session_id: int | None
    intake: Intake
    came_from_address: int
    version_id: int | None
    is_any_stale: bool
    are_any_old: bool


def standing_of(
    connection: Connection,
    served: ServedStudy,
    *,
    recruiter_participant: str | None,
    visit: str | None,
    address: str | None,
    now: datetime,
    in_turn: bool,
) -> Standing:
    """Return how things stand for who has this name, or where nobody has named them this visit.

    Parameters
    ----------
    in_turn : bool
        Whether it is asked in the allocation's turn.
    """
    row = connection.execute(
        STATEMENTS[recruiter_participant is not None, in_turn],
        {
            "who": visit if recruiter_participant is None else recruiter_participant,
            "address": address,
            "since": now - WINDOW,
            "design": served.design,
            "silent_since": silent_since(served, now),
        },
    ).one()
    return Standing(
        study_session_id=row.study_session_id,
        intake=intake_of(row.state, row.more_places),
        came_from_address=row.came,
        version_id=row.version_id,
        is_any_stale=row.is_any_stale,
        are_any_old=row.are_any_old,
    )


def _standing(who: InstrumentedAttribute[str | None], *, in_turn: bool) -> Select[Any]:
    known = select(StudySession.id).where(who == bindparam("who"))
    version = select(StudyVersion.id).where(StudyVersion.design == bindparam("design"))
    return select(
        known.scalar_subquery().label("study_session_id"),
        NEWEST_STATE.label("state"),
        NEWEST_MORE_PLACES.label("more_places"),
        CAME_FROM_ADDRESS.label("came"),
        version.scalar_subquery().label("version_id"),
        (IS_ANY_STALE if in_turn else false()).label("is_any_stale"),
        (ARE_ANY_OLD if in_turn else false()).label("are_any_old"),
    )


STATEMENTS: Final = {
    (named, in_turn): _standing(
        StudySession.recruiter_participant if named else StudySession.visit, in_turn=in_turn
    )
    for named in (False, True)
    for in_turn in (False, True)
}
"""By whether a recruiter names who arrives, and whether it is asked in the allocation's turn."""
