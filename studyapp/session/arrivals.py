"""Who arrives, and how things stand for them: known, let in, one of too many.

How many newcomers come from one network address is counted, so that nobody takes all places alone.
Only who got a place is counted, and for an hour; nothing says who came from where. Who has a link
that was made for them, or that Prolific has signed, is not counted.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from typing import Any, Final

from sqlalchemy import Connection, Select, bindparam, delete, exists, false, func, insert, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from studyapp.database.tables import Newcomer, StudySession, StudyVersion
from studyapp.session.intake import NEWEST_MORE_PLACES, NEWEST_STATE, Intake, intake_of
from studyapp.session.places import HAS_STALE_PLACE, has_open_place, stale_before
from studyapp.session.refusal import CrowdedAddressError, StudyFullError
from studyapp.session.served_study import ServedStudy

WINDOW: Final = timedelta(hours=1)


@dataclass(frozen=True, kw_only=True)
class Arrival:
    """Who comes, as far as anybody says so.

    Attributes
    ----------
    visit : str or None
        Drawn with the consent page, or the hash of an invitation; who knows it is the person who
        has the study session.
    recruiter_participant : str or None
        The recruiter's name for the participant, who takes part once, whatever the recruiter
        calls the study.
    recruiter_study, recruiter_session : str
        The recruiter's names for the study and the submission; may be empty.
    submit_to : str
        The recruiter's site that the end is to be reported to; may be empty.
    form : mapping of question name to text
        What was answered under eligibility and consent.
    token : str or None
        Of the study session that their browser says it has.
    is_signed : bool
        Whether the recruiter has signed who they are.
    address : str or None
        The network address they come from, where newcomers from it are counted.

    Raises
    ------
    ValueError
        If neither `visit` nor `recruiter_participant` says who it is.
    """

    visit: str | None = None
    recruiter_participant: str | None = None
    recruiter_study: str = ""
    recruiter_session: str = ""
    submit_to: str = ""
    form: Mapping[str, str] = field(default_factory=dict)
    token: str | None = None
    is_signed: bool = False
    address: str | None = None

    def __post_init__(self) -> None:
        if not self.visit and not self.recruiter_participant:
            raise ValueError("an arrival without a visit or a recruiter's name is nobody's")

    @property
    def name(self) -> str:
        """What tells them apart: the recruiter's name for them; the visit where there is none."""
        return self.recruiter_participant or self.visit or ""


NEWCOMERS_FROM_ADDRESS: Final = (
    select(func.count(Newcomer.id))
    .where(Newcomer.address == bindparam("address"), Newcomer.at > bindparam("since"))
    .scalar_subquery()
)
EXPIRED: Final = select(Newcomer.id).where(Newcomer.at <= bindparam("since"))
HAS_EXPIRED: Final = exists(EXPIRED)

# Those are passed over that somebody else forgets at this moment.
DELETE_EXPIRED: Final = delete(Newcomer).where(
    Newcomer.id.in_(EXPIRED.with_for_update(skip_locked=True))
)
INSERT_NEWCOMER: Final = insert(Newcomer)


def require_uncrowded_address(came: int, most: int) -> None:
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


def max_newcomers_from_one_address(session: Session, now: datetime) -> int:
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
    session.connection().execute(DELETE_EXPIRED, {"since": now - WINDOW})


def add_newcomer(session: Session, address: str | None, now: datetime) -> None:
    """Note that somebody from `address` got a place; None where nobody counts or knows it."""
    if address is not None:
        session.connection().execute(INSERT_NEWCOMER, {"at": now, "address": address})


def require_open_place(
    reading: Session | Connection, served: ServedStudy, intake: Intake, now: datetime
) -> None:
    """Raise `StudyFullError` unless newcomers are let in and there is a place for one."""
    require_open_intake(served, intake)
    if not has_open_place(reading, served, intake, now):
        raise full_study_error()


def require_open_intake(served: ServedStudy, intake: Intake) -> None:
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


def full_study_error() -> StudyFullError:
    """Return what newcomers are told while every place is held."""
    return StudyFullError(
        "The study has all the participants it needs at the moment.",
        "Thank you for your interest. A place may open again: you can try later with the "
        "same link.",
    )


@dataclass(frozen=True, kw_only=True)
class Admission:
    """How things stand for somebody who arrives.

    Attributes
    ----------
    study_session_id : int or None
        The study session that they have already.
    intake : Intake
        What researchers have decided.
    newcomers_from_address : int
        Newcomers from their network address within an hour.
    version_id : int or None
        The version that is served; None where it is not the database's any more.
    has_stale_place, has_expired_newcomers : bool
        Whether a place is held by somebody who has been silent for too long, and newcomers are
        noted who came longer than an hour ago; False outside the allocation's turn.
    """

    study_session_id: int | None
    intake: Intake
    newcomers_from_address: int
    version_id: int | None
    has_stale_place: bool
    has_expired_newcomers: bool


def read_admission(
    connection: Connection,
    served: ServedStudy,
    arrival: Arrival,
    now: datetime,
    *,
    in_turn: bool,
) -> Admission:
    """Return how things stand for who has this name, or where nobody has named them this visit.

    Parameters
    ----------
    in_turn : bool
        Whether it is asked in the allocation's turn.
    """
    row = connection.execute(
        ADMISSION_QUERIES[arrival.recruiter_participant is not None, in_turn],
        {
            "who": arrival.name,
            "address": arrival.address,
            "since": now - WINDOW,
            "design": served.design,
            "silent_since": stale_before(served, now),
        },
    ).one()
    return Admission(
        study_session_id=row.study_session_id,
        intake=intake_of(row.state, row.more_places),
        newcomers_from_address=row.came,
        version_id=row.version_id,
        has_stale_place=row.has_stale_place,
        has_expired_newcomers=row.has_expired_newcomers,
    )


def _admission_query(who: InstrumentedAttribute[str | None], *, in_turn: bool) -> Select[Any]:
    known = select(StudySession.id).where(who == bindparam("who"))
    version = select(StudyVersion.id).where(StudyVersion.design == bindparam("design"))
    return select(
        known.scalar_subquery().label("study_session_id"),
        NEWEST_STATE.label("state"),
        NEWEST_MORE_PLACES.label("more_places"),
        NEWCOMERS_FROM_ADDRESS.label("came"),
        version.scalar_subquery().label("version_id"),
        (HAS_STALE_PLACE if in_turn else false()).label("has_stale_place"),
        (HAS_EXPIRED if in_turn else false()).label("has_expired_newcomers"),
    )


ADMISSION_QUERIES: Final = {
    (named, in_turn): _admission_query(
        StudySession.recruiter_participant if named else StudySession.visit, in_turn=in_turn
    )
    for named in (False, True)
    for in_turn in (False, True)
}
"""By whether a recruiter names who arrives, and whether it is asked in the allocation's turn."""
