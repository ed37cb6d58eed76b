"""Enrolment: a participant consents and gets a place and trials; who returns, resumes."""

from __future__ import annotations

import threading
from datetime import datetime
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
from studyapp.session.intake import share_allocation_turn, take_allocation_turn, wanted_places
from studyapp.session.participation import left_at_sound_check
from studyapp.session.places import release_stale_places, stale_before, take_open_place
from studyapp.session.refusal import UnprovenError
from studyapp.session.served_study import ServedStudy, changed_study_error
from studyapp.session.trial_rows import count_votes, new_token, store_trials

ARRIVAL_SLOTS: Final = threading.BoundedSemaphore(4)
"""Arrivals that wait for the allocation's turn occupy a database connection each; without a limit,
none would be left for participants who answer."""

PLACES: Final = cast(Table, Place.__table__)
INSERT_STUDY_SESSION: Final = insert(cast(Table, StudySession.__table__)).returning(StudySession.id)
HOLD_PLACE: Final = (
    update(PLACES)
    .where(PLACES.c.id == bindparam("place"))
    .values(study_session_id=bindparam("holder"))
)


def enrol(database: Database, served: ServedStudy, arrival: Arrival, clock: Clock) -> str:
    """Give the arriving participant a study session and return its token.

    Participants who already have one get it back, whatever its state. Only those who left at the
    sound check start over: they had not seen anything yet.

    Raises
    ------
    StudyFullError
        If newcomers are not admitted, no place is open, or their address is crowded.
    UnacceptableError, IneligibleError
        If the answers to the questions of eligibility and consent do not let them take part.
    UnprovenError
        See `resume`.
    """
    while True:
        # Separate transactions: nobody may wait for a study session in the allocation's turn.
        token = _enrol_newcomer(database, served, arrival, clock) or resume(
            database, served, arrival, clock
        )
        if token is not None:
            return token


def resume(database: Database, served: ServedStudy, arrival: Arrival, clock: Clock) -> str | None:
    """Return the token of the study session to which the participant returns; None for newcomers.

    The recruiter's present submission is stored. A recruiter's name alone proves nothing: without
    other proof, somebody can resume only after `lease_minutes` of inactivity, when anybody might
    get the place, and that is stored too.

    Raises
    ------
    UnprovenError
        If the study session may be somebody else's, or is over.
    """
    with database.reading() as session:
        existing = session.scalars(_study_session_query(arrival)).first()
        if existing is None or left_at_sound_check(existing):
            return None
        if _is_proven(existing, arrival) and not _has_new_submission(existing, arrival):
            return existing.token
    with database.writing() as session:
        # Locked, so that nothing is stored about somebody who is being forgotten.
        existing = session.scalars(_study_session_query(arrival).with_for_update()).first()
        if existing is None or left_at_sound_check(existing):
            return None
        if not _is_proven(existing, arrival):
            _require_inactive(existing, served, clock.now())
            existing.unproven_at = clock.now()
        if _has_new_submission(existing, arrival):
            existing.recruiter_study = arrival.recruiter_study
            existing.recruiter_session = arrival.recruiter_session
            existing.submit_to = arrival.submit_to
        return existing.token


def _is_proven(existing: StudySession, arrival: Arrival) -> bool:
    """Tell whether more than a recruiter's name proves that `existing` is the arriving person's.

    The visit, the invitation or the browser's token do; so do the recruiter's signature and the
    recruiter's name for the submission.
    """
    submission = arrival.recruiter_session
    return (
        arrival.is_signed
        or (arrival.visit is not None and arrival.visit == existing.visit)
        or arrival.token == existing.token
        or (submission != "" and submission == existing.recruiter_session)
    )


def _require_inactive(existing: StudySession, served: ServedStudy, now: datetime) -> None:
    if _is_over(existing):
        raise UnprovenError(
            "Somebody with this participant ID has already taken part.",
            "If it was you, everything is stored: your last page is in the browser you used.",
        )
    if existing.last_active_at > stale_before(served, now):
        raise UnprovenError(
            "Somebody with this participant ID has begun in another browser.",
            "Please go on there. If you cannot, come back to this page {minutes} minutes after you "
            "last did anything there: then you can go on here.",
            minutes=served.study.lease_minutes,
        )


def require_admission(
    database: Database, served: ServedStudy, arrival: Arrival, clock: Clock
) -> None:
    """Turn newcomers away before any question if enrolment would; nothing is stored.

    Participants with a study session always get back to it.

    Raises
    ------
    StudyFullError
        If newcomers are not admitted, no place is open, or their address is crowded.
    """
    now = clock.now()
    with database.looking_up() as connection:
        admission = read_admission(connection, served, arrival, now, in_turn=False)
        if admission.study_session_id is None:
            _require_admission(connection, served, admission, now)
            return
    with database.reading() as session:
        if not _can_resume(session, admission):
            _require_admission(session, served, admission, now)


def _require_admission(
    reading: Session | Connection, served: ServedStudy, admission: Admission, now: datetime
) -> None:
    require_open_place(reading, served, admission.intake, now)
    require_uncrowded_address(served, admission)


def _enrol_newcomer(
    database: Database, served: ServedStudy, arrival: Arrival, clock: Clock
) -> str | None:
    """Return the token of a new study session; None for participants who can resume one."""
    now = clock.now()
    with ARRIVAL_SLOTS:
        with database.writing() as session:
            admission = _read_admission_in_turn(session, served, arrival, now)
            if not admission.has_stale_place or _can_resume(session, admission):
                return _enrol(session, served, arrival, admission, now)
        with database.writing() as session:
            take_allocation_turn(session)
            release_stale_places(session, served, now)
        with database.writing() as session:
            admission = _read_admission_in_turn(session, served, arrival, now)
            return _enrol(session, served, arrival, admission, now)


def _read_admission_in_turn(
    session: Session, served: ServedStudy, arrival: Arrival, now: datetime
) -> Admission:
    share_allocation_turn(session, arrival.name)
    return read_admission(session.connection(), served, arrival, now, in_turn=True)


def _enrol(
    session: Session, served: ServedStudy, arrival: Arrival, admission: Admission, now: datetime
) -> str | None:
    if _can_resume(session, admission):
        return None
    require_open_intake(served, admission.intake)
    require_uncrowded_address(served, admission)
    answers = read_entrance_answers(served.study, arrival.form, now)
    place = take_open_place(session, wanted_places(served, admission.intake))
    if place is None:
        raise full_study_error()
    if admission.version_id is None:
        raise changed_study_error()
    if (abandoned := _find_study_session(session, admission)) is not None:
        session.delete(abandoned)
        session.flush()  # no two study sessions may have the same name
    arm = served.arms[place.arm, place.design]
    token = new_token()
    connection = session.connection()
    study_session_id = connection.execute(
        INSERT_STUDY_SESSION,
        {
            "token": token,
            "visit": arrival.visit,
            "recruiter_participant": arrival.recruiter_participant,
            "recruiter_study": arrival.recruiter_study,
            "recruiter_session": arrival.recruiter_session,
            "submit_to": arrival.submit_to,
            "version_id": admission.version_id,
            "arm": place.arm,
            "arm_design": place.design,
            "number": place.number,
            "conditions": list(arm.conditions),
            "consented_at": now,
            "last_active_at": now,
        },
    ).scalar_one()
    connection.execute(HOLD_PLACE, {"place": place.id, "holder": study_session_id})
    if admission.has_expired_newcomers:
        forget_newcomers(session, now)
    add_newcomer(session, arrival.address, now)
    for answer in answers:
        answer.study_session_id = study_session_id
    session.add_all(answers)
    votes = count_votes(session, served)
    planned = served.study.plan(arm, place.number, served.segments, votes)
    store_trials(session, study_session_id, planned, served)
    return token


def _find_study_session(session: Session, admission: Admission) -> StudySession | None:
    """Return the study session that the arriving person already has."""
    if admission.study_session_id is None:
        return None
    return session.get(StudySession, admission.study_session_id)


def _can_resume(session: Session, admission: Admission) -> bool:
    """Tell whether the arriving person has a study session to resume."""
    existing = _find_study_session(session, admission)
    return existing is not None and not left_at_sound_check(existing)


def _study_session_query(arrival: Arrival) -> Select[StudySession]:
    """Select the study session of the arriving person."""
    if arrival.recruiter_participant is None:
        return select(StudySession).where(StudySession.visit == arrival.visit)
    return select(StudySession).where(
        StudySession.recruiter_participant == arrival.recruiter_participant
    )


def _has_new_submission(existing: StudySession, arrival: Arrival) -> bool:
    """Tell whether the recruiter sends an unfinished participant under another submission."""
    stored = (existing.recruiter_study, existing.recruiter_session, existing.submit_to)
    present = (arrival.recruiter_study, arrival.recruiter_session, arrival.submit_to)
    is_recruited = arrival.recruiter_participant is not None
    return is_recruited and not _is_over(existing) and stored != present


def _is_over(existing: StudySession) -> bool:
    return existing.completed_at is not None or existing.withdrawn_at is not None
