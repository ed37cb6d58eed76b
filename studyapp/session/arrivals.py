"""Arrivals: who comes, and whether they are known, admitted, or one of too many.

Newcomers from each network address are counted, so that nobody takes all places alone: only those
who got a place, for an hour, and without their names. Newcomers with a personal link, or one that
Prolific has signed, are not counted.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from typing import Any, Final, NamedTuple

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
    """Who arrives.

    Attributes
    ----------
    visit : str or None
        Random, drawn with the consent page, or the hash of an invitation; proves who has the study
        session.
    recruiter_participant : str or None
        The recruiter's name for the participant, who takes part only once, whatever the
        recruiter's study.
    recruiter_study, recruiter_session : str
        The recruiter's names for the study and the submission; may be empty.
    submit_to : str
        The recruiter's site to which the end is reported; may be empty.
    form : mapping of question name to text
        Answers to the questions of eligibility and consent.
    token : str or None
        Token of the study session that the browser claims to have.
    is_signed : bool
        Whether the recruiter has signed the participant's name.
    address : str or None
        The network address, if newcomers from it are counted.

    Raises
    ------
    ValueError
        If there is neither a `visit` nor a `recruiter_participant`.
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
            raise ValueError("an arrival needs a visit or a recruiter's name")

    @property
    def name(self) -> str:
        """The recruiter's name for the participant, or else the visit."""
        return self.recruiter_participant or self.visit or ""


NEWCOMERS_FROM_ADDRESS: Final = (
    select(func.count(Newcomer.id))
    .where(Newcomer.address == bindparam("address"), Newcomer.at > bindparam("since"))
    .scalar_subquery()
)
EXPIRED: Final = select(Newcomer.id).where(Newcomer.at <= bindparam("since"))
HAS_EXPIRED: Final = exists(EXPIRED)

# Rows that another transaction is deleting are skipped.
DELETE_EXPIRED: Final = delete(Newcomer).where(
    Newcomer.id.in_(EXPIRED.with_for_update(skip_locked=True))
)
INSERT_NEWCOMER: Final = insert(Newcomer)


def max_newcomers_from_one_address(session: Session, now: datetime) -> int:
    """Return the number of newcomers within an hour from the most crowded address."""
    counts = (
        select(func.count(Newcomer.id).label("newcomers"))
        .where(Newcomer.at > now - WINDOW)
        .group_by(Newcomer.address)
        .subquery()
    )
    return session.scalar(select(func.max(counts.c.newcomers))) or 0


def forget_newcomers(session: Session, now: datetime) -> None:
    """Forget newcomers who came more than an hour ago."""
    session.connection().execute(DELETE_EXPIRED, {"since": now - WINDOW})


def add_newcomer(session: Session, address: str | None, now: datetime) -> None:
    """Count a newcomer from `address`; None if nobody counts."""
    if address is not None:
        session.connection().execute(INSERT_NEWCOMER, {"at": now, "address": address})


def require_open_place(
    reading: Session | Connection, served: ServedStudy, intake: Intake, now: datetime
) -> None:
    """Raise `StudyFullError` unless newcomers are admitted and a place is open."""
    require_open_intake(served, intake)
    if not has_open_place(reading, served, intake, now):
        raise full_study_error()


def require_open_intake(served: ServedStudy, intake: Intake) -> None:
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


class Admission(NamedTuple):
    """What decides about admitting somebody who arrives.

    Attributes
    ----------
    study_session_id : int or None
        The study session that they already have.
    state, more_places
        The researchers' current decision; see `intake_of`.
    newcomers_from_address : int
        Newcomers from their network address within an hour.
    version_id : int or None
        The version that is served; None if the database has moved on to another.
    has_stale_place, has_expired_newcomers : bool
        Whether there are places to release and newcomers to forget; False outside the
        allocation's turn.
    """

    study_session_id: int | None
    state: str | None
    more_places: int | None
    newcomers_from_address: int
    version_id: int | None
    has_stale_place: bool
    has_expired_newcomers: bool

    @property
    def intake(self) -> Intake:
        """The researchers' current decision."""
        return intake_of(self.state, self.more_places)


def read_admission(
    connection: Connection,
    served: ServedStudy,
    arrival: Arrival,
    now: datetime,
    *,
    in_turn: bool,
) -> Admission:
    """Read what decides about admitting `arrival`.

    Parameters
    ----------
    in_turn : bool
        Whether the caller shares the allocation's turn.
    """
    row = connection.execute(
        ADMISSION_QUERIES[arrival.recruiter_participant is not None, in_turn],
        {
            "name": arrival.name,
            "address": arrival.address,
            "since": now - WINDOW,
            "design": served.design,
            "silent_since": stale_before(served, now),
        },
    ).one()
    return Admission(*row)


def require_uncrowded_address(served: ServedStudy, admission: Admission) -> None:
    """Raise `CrowdedAddressError` if too many newcomers come from one network address."""
    limit = served.study.recruitment.newcomers_per_address
    if limit and admission.newcomers_from_address >= limit:
        raise CrowdedAddressError(
            "Very many people have just begun this study from your network.",
            "Please come back in an hour: the same link works then.",
        )


def _admission_query(column: InstrumentedAttribute[str | None], *, in_turn: bool) -> Select[Any]:
    """Select the fields of `Admission`."""
    study_session = select(StudySession.id).where(column == bindparam("name"))
    version = select(StudyVersion.id).where(StudyVersion.design == bindparam("design"))
    return select(
        study_session.scalar_subquery(),
        NEWEST_STATE,
        NEWEST_MORE_PLACES,
        NEWCOMERS_FROM_ADDRESS,
        version.scalar_subquery(),
        HAS_STALE_PLACE if in_turn else false(),
        HAS_EXPIRED if in_turn else false(),
    )


ADMISSION_QUERIES: Final = {
    (is_recruited, in_turn): _admission_query(
        StudySession.recruiter_participant if is_recruited else StudySession.visit, in_turn=in_turn
    )
    for is_recruited in (False, True)
    for in_turn in (False, True)
}
"""By whether a recruiter names the participant, and whether the allocation's turn is shared."""
