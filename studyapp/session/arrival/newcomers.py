"""How many newcomers come from one network address, so that nobody takes all places alone.

Only who got a place is counted, and for an hour; nothing says who came from where. Who has a link
that was made for them, or that Prolific has signed, is not counted.
"""

from __future__ import annotations

from datetime import datetime, timedelta
from typing import Final

from sqlalchemy import Connection, bindparam, delete, exists, func, insert, select
from sqlalchemy.orm import Session

from studyapp.database.tables import Newcomer
from studyapp.session.arrival.intake import Intake
from studyapp.session.arrival.places import has_open_place
from studyapp.session.refusal import CrowdedAddressError, StudyFullError
from studyapp.session.served_study import ServedStudy

WINDOW: Final = timedelta(hours=1)


CAME_FROM_ADDRESS: Final = (
    select(func.count(Newcomer.id))
    .where(Newcomer.address == bindparam("address"), Newcomer.at > bindparam("since"))
    .scalar_subquery()
)
OLD: Final = select(Newcomer.id).where(Newcomer.at <= bindparam("since"))
ARE_ANY_OLD: Final = exists(OLD)

# Those are passed over that somebody else forgets at this moment.
FORGET: Final = delete(Newcomer).where(Newcomer.id.in_(OLD.with_for_update(skip_locked=True)))
COUNT: Final = insert(Newcomer)


def require_uncrowded(came: int, most: int) -> None:
    """Raise `CrowdedAddressError` if so many newcomers from one address are the most there may be.

    Parameters
    ----------
    came : int
        How many have come from it within an hour.
    most : int
        0 for any number.
    """
    if most and came >= most:
        raise CrowdedAddressError(
            "Very many people have just begun this study from your network.",
            "Please come back in an hour: the same link works then.",
        )


def most_from_one_address(session: Session, now: datetime) -> int:
    """Return how many newcomers came within an hour from the address from which most came."""
    counts = (
        select(func.count(Newcomer.id).label("came"))
        .where(Newcomer.at > now - WINDOW)
        .group_by(Newcomer.address)
        .subquery()
    )
    return session.scalar(select(func.max(counts.c.came))) or 0


def forget_newcomers(session: Session, now: datetime) -> None:
    """Forget who came longer than an hour ago."""
    session.connection().execute(FORGET, {"since": now - WINDOW})


def count_newcomer(session: Session, address: str | None, now: datetime) -> None:
    """Note that somebody from `address` got a place; None where nobody counts or knows it."""
    if address is not None:
        session.connection().execute(COUNT, {"at": now, "address": address})


def require_room(
    reading: Session | Connection, served: ServedStudy, intake: Intake, now: datetime
) -> None:
    """Raise `StudyFullError` unless newcomers are let in and there is a place for one."""
    require_let_in(served, intake)
    if not has_open_place(reading, served, intake, now):
        raise study_is_full()


def require_let_in(served: ServedStudy, intake: Intake) -> None:
    """Raise `StudyFullError` unless newcomers are let in, whether or not there is a place."""
    state = intake.state
    if state == "closed":
        raise StudyFullError(
            "The study is over: it takes no more participants.",
            "Thank you for your interest.",
        )
    if state == "paused":
        raise StudyFullError(
            "The study is paused at the moment.",
            "Thank you for your interest. Please come back later: the same link works then.",
        )
    if not served.study.open:
        raise StudyFullError(
            "The study takes no new participants at the moment.",
            "Thank you for your interest. You can try later with the same link.",
        )


def study_is_full() -> StudyFullError:
    """Return what newcomers are told while every place is held."""
    return StudyFullError(
        "The study has all the participants it needs at the moment.",
        "Thank you for your interest. A place may open again: you can try later with the "
        "same link.",
    )
