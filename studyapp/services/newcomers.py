"""How many newcomers come from one network address, so that nobody takes all places alone.

Only who got a place is counted, and for an hour; nothing says who came from where. Who has a link
that was made for them, or that Prolific has signed, is not counted.
"""

from __future__ import annotations

from datetime import datetime, timedelta
from typing import Final

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session

from studyapp.models import Newcomer
from studyapp.services.refusal import CrowdedAddressError

WINDOW: Final = timedelta(hours=1)


def require_uncrowded(session: Session, address: str | None, most: int, now: datetime) -> None:
    """Raise `CrowdedAddressError` if `most` newcomers have come from `address` within an hour.

    Parameters
    ----------
    address : str or None
        None where it does not matter, or nobody knows it.
    most : int
        0 for any number.
    """
    if address is None or not most:
        return
    of_address = select(func.count(Newcomer.id)).where(
        Newcomer.address == address, Newcomer.at > now - WINDOW
    )
    if session.scalars(of_address).one() >= most:
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


def count_newcomer(session: Session, address: str | None, now: datetime) -> None:
    """Note that somebody from `address` got a place, and forget those of longer ago."""
    # Those are passed over that somebody else forgets at this moment.
    old = select(Newcomer.id).where(Newcomer.at <= now - WINDOW)
    forgotten = session.scalars(old.with_for_update(skip_locked=True)).all()
    if forgotten:
        session.execute(delete(Newcomer).where(Newcomer.id.in_(forgotten)))
    if address is not None:
        session.add(Newcomer(at=now, address=address))
