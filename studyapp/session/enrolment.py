"""Enrolment: a participant agrees, and gets a place and their trials; coming again resumes."""

from __future__ import annotations

import threading
from datetime import datetime, timedelta
from typing import Final, cast

from sqlalchemy import Connection, Select, Table, bindparam, insert, select, update
from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import Place, StudySession
from studyapp.session.arrivals import (
    Arrival,
    Standing,
    count_newcomer,
    forget_newcomers,
    require_let_in,
    require_room,
    require_uncrowded,
    standing_of,
    study_is_full,
)
from studyapp.session.form_answers import entrance_answers
from studyapp.session.intake import (
    share_allocation_turn,
    take_allocation_turn,
    wanted_places,
)
from studyapp.session.participation import left_unheard
from studyapp.session.places import (
    release_stale,
    take_open_place,
)
from studyapp.session.refusal import UnprovenError
from studyapp.session.served_study import ServedStudy, study_has_changed
from studyapp.session.trial_rows import new_token, store_trials, votes_so_far

ARRIVALS: Final = threading.BoundedSemaphore(4)
"""Who waits for the allocation's turn keeps a connection to the database. A process whose arrivals
all did would have none left for those who answer."""

PLACES: Final = cast(Table, Place.__table__)
NEWCOMER: Final = insert(cast(Table, StudySession.__table__)).returning(StudySession.id)
HOLD: Final = (
    update(PLACES)
    .where(PLACES.c.id == bindparam("place"))
    .values(study_session_id=bindparam("own"))
)


def enrol(database: Database, served: ServedStudy, arrival: Arrival, clock: Clock) -> str:
    """Give the arriving participant a study session and return its token.

    Whoever has one already gets that one back, whatever its state. Only who left at the sound
    check begins anew: they had seen nothing yet.

    Raises
    ------
    StudyFullError
        If nobody new is let in, no place is open, or too many have come from their address.
    UnacceptableError, IneligibleError
        If the answers under eligibility and consent do not let them take part.
    UnprovenError
        If the study session of this name was begun elsewhere; see `enrolled`.
    """
    while True:
        # Apart, since whoever shares the allocation's turn must wait for no study session.
        token = _as_newcomer(database, served, arrival, clock) or enrolled(
            database, served, arrival, clock
        )
        if token is not None:
            return token


def enrolled(database: Database, served: ServedStudy, arrival: Arrival, clock: Clock) -> str | None:
    """Return the token of the study session that the arriving participant comes back to, if any.

    Under which of the recruiter's submissions they come now is noted. A name alone shows nothing:
    who has nothing else goes on only once nobody else has for `lease_minutes`, when anybody might
    get the place, and that is noted too.

    Raises
    ------
    UnprovenError
        If somebody else may have the study session, or it is over.
    """
    with database.reading() as session:
        known = session.scalars(_known(arrival)).first()
        if known is None or left_unheard(known):
            return None
        if _is_proven(known, arrival) and not _comes_otherwise(known, arrival):
            return known.token
    with database.writing() as session:
        # Locked, so that nothing is noted of somebody who is being forgotten.
        known = session.scalars(_known(arrival).with_for_update()).first()
        if known is None or left_unheard(known):
            return None
        if not _is_proven(known, arrival):
            _require_silent(known, served, clock.now())
            known.unproven_at = clock.now()
        if _comes_otherwise(known, arrival):
            known.recruiter_study = arrival.recruiter_study
            known.recruiter_session = arrival.recruiter_session
            known.submit_to = arrival.submit_to
        return known.token


def _is_proven(known: StudySession, arrival: Arrival) -> bool:
    """Tell whether more than a recruiter's name shows that the person of `known` has come.

    What was drawn for them does: the visit or invitation, the token that their browser keeps. So
    does the recruiter's signature, and the recruiter's own name for the submission they began in.
    """
    return (
        arrival.is_signed
        or (arrival.visit is not None and arrival.visit == known.visit)
        or arrival.token == known.token
        or (
            arrival.recruiter_session != "" and arrival.recruiter_session == known.recruiter_session
        )
    )


def _require_silent(known: StudySession, served: ServedStudy, now: datetime) -> None:
    if _is_over(known):
        raise UnprovenError(
            "Somebody with this participant name has already taken part.",
            "If it was you, everything is stored: your last page is in the browser you used.",
        )
    if known.last_active_at > now - timedelta(minutes=served.study.lease_minutes):
        raise UnprovenError(
            "Somebody with this participant name has begun in another browser.",
            "Please go on there. If you cannot, come back to this page {minutes} minutes after you "
            "last did anything there: then you can go on here.",
            minutes=served.study.lease_minutes,
        )


def require_welcome(
    database: Database, served: ServedStudy, arrival: Arrival, clock: Clock
) -> None:
    """Turn newcomers away before they are asked anything, where enrolling would; nothing is stored.

    Whoever has a study session already comes back to it in any case.

    Raises
    ------
    StudyFullError
        If nobody new is let in, or no place is open.
    """
    now = clock.now()
    with database.looking_up() as connection:
        standing = standing_of(connection, served, arrival, now, in_turn=False)
        if standing.study_session_id is None:
            _require_welcome(connection, served, standing, now)
            return
    with database.reading() as session:
        if not _goes_on(session, standing):
            _require_welcome(session, served, standing, now)


def _require_welcome(
    reading: Session | Connection, served: ServedStudy, standing: Standing, now: datetime
) -> None:
    require_room(reading, served, standing.intake, now)
    require_uncrowded(standing.came_from_address, served.study.recruitment.newcomers_per_address)


def _as_newcomer(
    database: Database, served: ServedStudy, arrival: Arrival, clock: Clock
) -> str | None:
    """Return the token of a new study session; None for who has one to go on with."""
    now = clock.now()
    with ARRIVALS:
        with database.writing() as session:
            standing = _standing_in_turn(session, served, arrival, now)
            if not standing.is_any_stale or _goes_on(session, standing):
                return _enrol(session, served, arrival, standing, now)
        with database.writing() as session:
            take_allocation_turn(session)
            release_stale(session, served, now)
        with database.writing() as session:
            standing = _standing_in_turn(session, served, arrival, now)
            return _enrol(session, served, arrival, standing, now)


def _standing_in_turn(
    session: Session, served: ServedStudy, arrival: Arrival, now: datetime
) -> Standing:
    share_allocation_turn(session, arrival.name)
    return standing_of(session.connection(), served, arrival, now, in_turn=True)


def _enrol(
    session: Session, served: ServedStudy, arrival: Arrival, standing: Standing, now: datetime
) -> str | None:
    if _goes_on(session, standing):
        return None
    require_let_in(served, standing.intake)
    require_uncrowded(standing.came_from_address, served.study.recruitment.newcomers_per_address)
    answers = entrance_answers(served.study, arrival.form, now)
    place = take_open_place(session, wanted_places(served, standing.intake))
    if place is None:
        raise study_is_full()
    if standing.version_id is None:
        raise study_has_changed()
    if (unheard := _begun(session, standing)) is not None:
        session.delete(unheard)
        session.flush()  # no two study sessions may have the same name
    arm = served.arms[place.arm, place.design]
    token = new_token()
    connection = session.connection()
    own = connection.execute(
        NEWCOMER,
        {
            "token": token,
            "visit": arrival.visit,
            "recruiter_participant": arrival.recruiter_participant,
            "recruiter_study": arrival.recruiter_study,
            "recruiter_session": arrival.recruiter_session,
            "submit_to": arrival.submit_to,
            "version_id": standing.version_id,
            "arm": place.arm,
            "arm_design": place.design,
            "number": place.number,
            "conditions": list(arm.conditions),
            "consented_at": now,
            "last_active_at": now,
        },
    ).scalar_one()
    connection.execute(HOLD, {"place": place.id, "own": own})
    if standing.are_any_old:
        forget_newcomers(session, now)
    count_newcomer(session, arrival.address, now)
    for answer in answers:
        answer.study_session_id = own
    session.add_all(answers)
    votes = votes_so_far(session, served)
    planned = served.study.plan(arm, place.number, served.segments, votes)
    store_trials(session, own, planned, served)
    return token


def _begun(session: Session, standing: Standing) -> StudySession | None:
    """Return the study session that who arrives has already."""
    if standing.study_session_id is None:
        return None
    return session.get(StudySession, standing.study_session_id)


def _goes_on(session: Session, standing: Standing) -> bool:
    """Tell whether they have one that they come back to."""
    known = _begun(session, standing)
    return known is not None and not left_unheard(known)


def _known(arrival: Arrival) -> Select[StudySession]:
    """Select the study session of who arrives."""
    if arrival.recruiter_participant is None:
        return select(StudySession).where(StudySession.visit == arrival.visit)
    return select(StudySession).where(
        StudySession.recruiter_participant == arrival.recruiter_participant
    )


def _comes_otherwise(known: StudySession, arrival: Arrival) -> bool:
    """Tell whether the recruiter sends them under another submission than is noted.

    What was finished under one is not finished again under another.
    """
    noted = (known.recruiter_study, known.recruiter_session, known.submit_to)
    told = (arrival.recruiter_study, arrival.recruiter_session, arrival.submit_to)
    return arrival.recruiter_participant is not None and not _is_over(known) and noted != told


def _is_over(known: StudySession) -> bool:
    return known.completed_at is not None or known.withdrawn_at is not None
