"""Enrolment: a participant agrees, and gets a place and their trials; coming again resumes."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Final

from sqlalchemy import Select, select
from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.models import StudySession
from studyapp.services.database import Database
from studyapp.services.form_answers import entrance_answers
from studyapp.services.letting_in import require_let_in, require_room, study_is_full
from studyapp.services.places import least_filled, release_stale, take_allocation_turn
from studyapp.services.served_study import ServedStudy
from studyapp.services.sound_check import left_unheard
from studyapp.services.trial_rows import new_token, store_trials
from studyapp.services.versions import present_version
from studyapp.services.votes import votes_so_far

ONE_ARRIVAL: Final = threading.Lock()
"""Who waits for the allocation's turn keeps a connection to the database. A process whose arrivals
all did would have none left for those who answer."""


@dataclass(frozen=True, kw_only=True)
class Arrival:
    """Who comes, as far as anybody says so.

    Attributes
    ----------
    visit : str or None
        Drawn with the consent page, or the hash of an invitation; the same one always means the
        same study session.
    recruiter_participant : str or None
        The recruiter's name for the participant, who takes part once in each of the
        recruiter's studies.
    recruiter_study, recruiter_session : str
        The recruiter's names for the study and the sitting; may be empty.
    once_for_all : bool
        Whether the participant is known whatever the recruiter calls the study.
    submit_to : str
        The recruiter's site that the end is to be reported to; may be empty.
    form : mapping of question name to text
        What was answered under eligibility and consent.

    Raises
    ------
    ValueError
        If neither `visit` nor `recruiter_participant` says who it is.
    """

    visit: str | None = None
    recruiter_participant: str | None = None
    recruiter_study: str = ""
    recruiter_session: str = ""
    once_for_all: bool = False
    submit_to: str = ""
    form: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.visit and not self.recruiter_participant:
            raise ValueError("an arrival without a visit or a recruiter's name is nobody's")


def enrol(database: Database, served: ServedStudy, arrival: Arrival, clock: Clock) -> str:
    """Give the arriving participant a study session and return its token.

    Whoever has one already gets that one back, whatever its state. Only who left at the sound
    check begins anew: they had seen nothing yet.

    Raises
    ------
    StudyFullError
        If nobody new is let in, or no place is open.
    UnacceptableError, IneligibleError
        If the answers under eligibility and consent do not let them take part.
    """
    # Before the allocation's turn: whoever has that must wait for no study session.
    token = enrolled(database, arrival)
    if token is not None:
        return token
    with ONE_ARRIVAL, database.writing() as session:
        return _enrol(session, served, arrival, clock.now())


def enrolled(database: Database, arrival: Arrival) -> str | None:
    """Return the token of the study session that the arriving participant comes back to, if any.

    Under which of the recruiter's sittings they are there now is noted.
    """
    with database.reading() as session:
        known = session.scalars(_known(arrival)).first()
        if known is None or left_unheard(known):
            return None
        if not _comes_otherwise(known, arrival):
            return known.token
    with database.writing() as session:
        # Locked, so that nothing is noted of somebody who is being forgotten.
        known = session.scalars(_known(arrival).with_for_update()).first()
        if known is None or left_unheard(known):
            return None
        if _comes_otherwise(known, arrival):
            known.recruiter_study = arrival.recruiter_study
            known.recruiter_session = arrival.recruiter_session
            known.submit_to = arrival.submit_to
        return known.token


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
    with database.reading() as session:
        known = session.scalars(_known(arrival)).first()
        if known is None or left_unheard(known):
            require_room(session, served, clock.now())


def _enrol(session: Session, served: ServedStudy, arrival: Arrival, now: datetime) -> str:
    take_allocation_turn(session)
    known = session.scalars(_known(arrival)).first()
    if known is not None and not left_unheard(known):
        return known.token
    require_let_in(session, served)
    answers = entrance_answers(served.study, arrival.form, now)
    release_stale(session, served, now)
    place = least_filled(session, served)
    if place is None:
        raise study_is_full()
    if known is not None:
        session.delete(known)
        session.flush()  # no two study sessions may have the same name
    study_session = StudySession(
        token=new_token(),
        visit=arrival.visit,
        recruiter_participant=arrival.recruiter_participant,
        recruiter_study=arrival.recruiter_study,
        recruiter_session=arrival.recruiter_session,
        submit_to=arrival.submit_to,
        version=present_version(session, served),
        arm=place.arm,
        arm_design=place.design,
        number=place.number,
        conditions=list(served.arms[place.arm, place.design].conditions),
        consented_at=now,
        last_active_at=now,
        form_answers=answers,
    )
    session.add(study_session)
    place.study_session = study_session
    session.flush()
    arm = served.arms[place.arm, place.design]
    planned = served.study.plan(arm, place.number, served.segments, votes_so_far(session, served))
    store_trials(session, study_session.id, planned, served)
    return study_session.token


def _known(arrival: Arrival) -> Select[StudySession]:
    """Select the study sessions of who arrives, that of the same recruiter's study first."""
    same_study = StudySession.recruiter_study == arrival.recruiter_study
    if arrival.recruiter_participant is None:
        return select(StudySession).where(StudySession.visit == arrival.visit)
    same = StudySession.recruiter_participant == arrival.recruiter_participant
    if arrival.once_for_all:
        return select(StudySession).where(same).order_by(same_study.desc(), StudySession.id)
    return select(StudySession).where(same, same_study)


def _comes_otherwise(known: StudySession, arrival: Arrival) -> bool:
    """Tell whether the recruiter sends them by another sitting than is noted.

    What was finished under one is not finished again under another.
    """
    over = known.completed_at is not None or known.withdrawn_at is not None
    noted = (known.recruiter_study, known.recruiter_session, known.submit_to)
    told = (arrival.recruiter_study, arrival.recruiter_session, arrival.submit_to)
    return arrival.recruiter_participant is not None and not over and noted != told
