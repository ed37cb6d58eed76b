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
    Admission,
    Arrival,
    add_newcomer,
    forget_newcomers,
    full_study_error,
    read_admission,
    require_open_intake,
    require_open_place,
    require_uncrowded_address,
)
from studyapp.session.form_answers import read_entrance_answers
from studyapp.session.intake import (
    share_allocation_turn,
    take_allocation_turn,
    wanted_places,
)
from studyapp.session.participation import left_at_sound_check
from studyapp.session.places import (
    release_stale_places,
    take_open_place,
)
from studyapp.session.refusal import UnprovenError
from studyapp.session.served_study import ServedStudy, changed_study_error
from studyapp.session.trial_rows import count_votes, new_token, store_trials

ARRIVAL_SLOTS: Final = threading.BoundedSemaphore(4)
"""Who waits for the allocation's turn keeps a connection to the database. A process whose arrivals
all did would have none left for those who answer."""

PLACES: Final = cast(Table, Place.__table__)
INSERT_STUDY_SESSION: Final = insert(cast(Table, StudySession.__table__)).returning(StudySession.id)
HOLD_PLACE: Final = (
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
        If the study session of this name was begun elsewhere; see `resume`.
    """
    while True:
        # Apart, since whoever shares the allocation's turn must wait for no study session.
        token = _enrol_newcomer(database, served, arrival, clock) or resume(
            database, served, arrival, clock
        )
        if token is not None:
            return token


def resume(database: Database, served: ServedStudy, arrival: Arrival, clock: Clock) -> str | None:
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
        known = session.scalars(_study_session_query(arrival)).first()
        if known is None or left_at_sound_check(known):
            return None
        if _is_proven(known, arrival) and not _has_new_submission(known, arrival):
            return known.token
    with database.writing() as session:
        # Locked, so that nothing is noted of somebody who is being forgotten.
        known = session.scalars(_study_session_query(arrival).with_for_update()).first()
        if known is None or left_at_sound_check(known):
            return None
        if not _is_proven(known, arrival):
            _require_inactive(known, served, clock.now())
            known.unproven_at = clock.now()
        if _has_new_submission(known, arrival):
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


def _require_inactive(known: StudySession, served: ServedStudy, now: datetime) -> None:
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


def require_admission(
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
        standing = read_admission(connection, served, arrival, now, in_turn=False)
        if standing.study_session_id is None:
            _require_admission(connection, served, standing, now)
            return
    with database.reading() as session:
        if not _can_resume(session, standing):
            _require_admission(session, served, standing, now)


def _require_admission(
    reading: Session | Connection, served: ServedStudy, standing: Admission, now: datetime
) -> None:
    require_open_place(reading, served, standing.intake, now)
    require_uncrowded_address(
        standing.newcomers_from_address, served.study.recruitment.newcomers_per_address
    )


def _enrol_newcomer(
    database: Database, served: ServedStudy, arrival: Arrival, clock: Clock
) -> str | None:
    """Return the token of a new study session; None for who has one to go on with."""
    now = clock.now()
    with ARRIVAL_SLOTS:
        with database.writing() as session:
            standing = _read_admission_in_turn(session, served, arrival, now)
            if not standing.has_stale_place or _can_resume(session, standing):
                return _enrol(session, served, arrival, standing, now)
        with database.writing() as session:
            take_allocation_turn(session)
            release_stale_places(session, served, now)
        with database.writing() as session:
            standing = _read_admission_in_turn(session, served, arrival, now)
            return _enrol(session, served, arrival, standing, now)


def _read_admission_in_turn(
    session: Session, served: ServedStudy, arrival: Arrival, now: datetime
) -> Admission:
    share_allocation_turn(session, arrival.name)
    return read_admission(session.connection(), served, arrival, now, in_turn=True)


def _enrol(
    session: Session, served: ServedStudy, arrival: Arrival, standing: Admission, now: datetime
) -> str | None:
    if _can_resume(session, standing):
        return None
    require_open_intake(served, standing.intake)
    require_uncrowded_address(
        standing.newcomers_from_address, served.study.recruitment.newcomers_per_address
    )
    answers = read_entrance_answers(served.study, arrival.form, now)
    place = take_open_place(session, wanted_places(served, standing.intake))
    if place is None:
        raise full_study_error()
    if standing.version_id is None:
        raise changed_study_error()
    if (unheard := _find_study_session(session, standing)) is not None:
        session.delete(unheard)
        session.flush()  # no two study sessions may have the same name
    arm = served.arms[place.arm, place.design]
    token = new_token()
    connection = session.connection()
    own = connection.execute(
        INSERT_STUDY_SESSION,
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
    connection.execute(HOLD_PLACE, {"place": place.id, "own": own})
    if standing.has_expired_newcomers:
        forget_newcomers(session, now)
    add_newcomer(session, arrival.address, now)
    for answer in answers:
        answer.study_session_id = own
    session.add_all(answers)
    votes = count_votes(session, served)
    planned = served.study.plan(arm, place.number, served.segments, votes)
    store_trials(session, own, planned, served)
    return token


def _find_study_session(session: Session, standing: Admission) -> StudySession | None:
    """Return the study session that who arrives has already."""
    if standing.study_session_id is None:
        return None
    return session.get(StudySession, standing.study_session_id)


def _can_resume(session: Session, standing: Admission) -> bool:
    """Tell whether they have one that they come back to."""
    known = _find_study_session(session, standing)
    return known is not None and not left_at_sound_check(known)


def _study_session_query(arrival: Arrival) -> Select[StudySession]:
    """Select the study session of who arrives."""
    if arrival.recruiter_participant is None:
        return select(StudySession).where(StudySession.visit == arrival.visit)
    return select(StudySession).where(
        StudySession.recruiter_participant == arrival.recruiter_participant
    )


def _has_new_submission(known: StudySession, arrival: Arrival) -> bool:
    """Tell whether the recruiter sends them under another submission than is noted.

    What was finished under one is not finished again under another.
    """
    noted = (known.recruiter_study, known.recruiter_session, known.submit_to)
    told = (arrival.recruiter_study, arrival.recruiter_session, arrival.submit_to)
    return arrival.recruiter_participant is not None and not _is_over(known) and noted != told


def _is_over(known: StudySession) -> bool:
    return known.completed_at is not None or known.withdrawn_at is not None
