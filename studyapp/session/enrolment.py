"""Enrolment: a participant arrives, consents, and gets a place and trials; who returns, resumes.

Newcomers from each network address are counted, so that nobody takes all places alone: only those
who got a place, for an hour, and without their names. Newcomers with a personal link, or one that
Prolific has signed, are not counted.
"""

import threading
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from typing import Final

from sqlalchemy import Select, delete, func, select, tuple_, update
from sqlalchemy.orm import Session, aliased

from analysis.answers.table import ANALYSED_KINDS
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.study_session import Newcomer, Place, StudySession, StudyVersion
from studyapp.database.tables.trial import Response, Trial, TrialStimulus
from studyapp.researchers.exclusion_decisions import current_exclusions
from studyapp.session.form_answers import read_entrance_answers
from studyapp.session.intake import (
    current_intake,
    share_allocation_turn,
    take_allocation_turn,
    wanted_places,
)
from studyapp.session.places import (
    full_study_error,
    has_stale_places,
    release_stale_places,
    require_open_intake,
    require_open_place,
    stale_before,
    take_open_place,
)
from studyapp.session.refusal import CrowdedAddressError, TakenPartError, UnprovenError
from studyapp.session.served_study import ServedStudy, changed_study_error
from studyapp.session.trials import new_token, store_trials
from studyapp.study.design.trial import NO_VOTES, Tally

ARRIVAL_SLOTS: Final = threading.BoundedSemaphore(4)
"""Arrivals that wait for the allocation's turn occupy a database connection each; without a limit,
none would be left for participants who answer."""

WINDOW: Final = timedelta(hours=1)
"""For how long newcomers from a network address are counted."""


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

    @property
    def name(self) -> str:
        """The recruiter's name for the participant, or else the visit."""
        return self.recruiter_participant or self.visit or ""


def enrol(database: Database, served: ServedStudy, arrival: Arrival, clock: Clock) -> str:
    """Give the arriving participant a study session and return its token.

    Participants who already have one get it back, whatever its state.

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
        token = resume(database, served, arrival, clock) or _enrol_newcomer(
            database, served, arrival, clock.now()
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
        if existing is None:
            return None
        if _is_proven(existing, arrival) and not _has_new_submission(existing, arrival):
            return existing.token
    with database.writing() as session:
        # Locked, so that nothing is stored about somebody who is being forgotten.
        existing = session.scalars(_study_session_query(arrival).with_for_update()).first()
        if existing is None:
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
        raise TakenPartError(
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
    with database.reading() as session:
        if session.scalars(_study_session_query(arrival)).first() is None:
            require_open_place(session, served, current_intake(session), now)
            _require_uncrowded_address(session, served, arrival, now)


def _enrol_newcomer(
    database: Database, served: ServedStudy, arrival: Arrival, now: datetime
) -> str | None:
    """Return the token of a new study session; None if they have got one just before."""
    with ARRIVAL_SLOTS:
        with database.reading() as session:
            has_stale = has_stale_places(session, served, now)
        if has_stale:
            with database.writing() as session:
                take_allocation_turn(session)
                release_stale_places(session, served, now)
        with database.writing() as session:
            share_allocation_turn(session, arrival.name)
            return _enrol(session, served, arrival, now)


def _enrol(session: Session, served: ServedStudy, arrival: Arrival, now: datetime) -> str | None:
    if session.scalars(_study_session_query(arrival)).first() is not None:
        return None
    intake = current_intake(session)
    require_open_intake(served, intake)
    _require_uncrowded_address(session, served, arrival, now)
    answers = read_entrance_answers(served.study, arrival.form, now)
    place = take_open_place(session, wanted_places(served, intake))
    if place is None:
        raise full_study_error()
    version = select(StudyVersion.id).where(StudyVersion.design == served.design)
    version_id = session.scalar(version)
    if version_id is None:
        raise changed_study_error()
    arm = served.arms[place.arm, place.design]
    planned = served.study.plan(arm, place.number, served.segments, count_votes(session, served))
    study_session = StudySession(
        token=new_token(),
        visit=arrival.visit,
        recruiter_participant=arrival.recruiter_participant,
        recruiter_study=arrival.recruiter_study,
        recruiter_session=arrival.recruiter_session,
        submit_to=arrival.submit_to,
        version_id=version_id,
        arm=place.arm,
        arm_design=place.design,
        number=place.number,
        conditions=list(arm.conditions),
        consented_at=now,
        last_active_at=now,
        form_answers=answers,
    )
    session.add(study_session)
    session.flush()
    store_trials(session, study_session.id, planned, served)
    session.execute(
        update(Place).where(Place.id == place.id).values(study_session_id=study_session.id)
    )
    add_newcomer(session, arrival.address, now)
    return study_session.token


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


def add_newcomer(session: Session, address: str | None, now: datetime) -> None:
    """Count a newcomer from `address`, None if nobody counts; forget those of an hour ago."""
    expired = select(Newcomer.id).where(Newcomer.at <= now - WINDOW)
    # Rows that another transaction is deleting are skipped.
    session.execute(
        delete(Newcomer).where(Newcomer.id.in_(expired.with_for_update(skip_locked=True))),
        execution_options={"synchronize_session": False},
    )
    if address is not None:
        session.add(Newcomer(at=now, address=address))


def max_newcomers_from_one_address(session: Session, now: datetime) -> int:
    """Return the number of newcomers within an hour from the most crowded address."""
    counts = (
        select(func.count(Newcomer.id).label("newcomers"))
        .where(Newcomer.at > now - WINDOW)
        .group_by(Newcomer.address)
        .subquery()
    )
    return session.scalar(select(func.max(counts.c.newcomers))) or 0


def _require_uncrowded_address(
    session: Session, served: ServedStudy, arrival: Arrival, now: datetime
) -> None:
    """Raise `CrowdedAddressError` if too many newcomers come from one network address."""
    limit = served.study.recruitment.newcomers_per_address
    recent = select(func.count(Newcomer.id)).where(
        Newcomer.address == arrival.address, Newcomer.at > now - WINDOW
    )
    if limit and arrival.address is not None and (session.scalar(recent) or 0) >= limit:
        raise CrowdedAddressError(
            "Very many people have just begun this study from your network.",
            "Please come back in an hour: the same link works then.",
        )


def count_votes(session: Session, served: ServedStudy) -> Tally:
    """Count how often each condition was preferred on the study's first question.

    Empty unless the study follows votes. Participants who withdrew, were excluded by hand or took
    part in an earlier design do not vote. Slight and clear preferences count alike, and no
    difference is half a vote for both.
    """
    if not served.study.follows_votes:
        return NO_VOTES
    first, second = aliased(TrialStimulus), aliased(TrialStimulus)
    rows = session.execute(
        select(first.condition, second.condition, Response.value)
        .join(Trial, Trial.id == Response.trial_id)
        .join(StudySession, StudySession.id == Trial.study_session_id)
        .join(first, (first.trial_id == Trial.id) & (first.number == 1))
        .join(second, (second.trial_id == Trial.id) & (second.number == 2))
        .where(
            Trial.kind.in_(ANALYSED_KINDS),
            Response.question == served.study.questions[0].name,
            StudySession.withdrawn_at.is_(None),
            tuple_(StudySession.arm, StudySession.arm_design).in_(list(served.arms)),
            StudySession.id.not_in(select(current_exclusions().subquery().c.study_session_id)),
        )
    )
    votes: defaultdict[tuple[str, str], float] = defaultdict(float)
    for a, b, value in rows:
        share = 0.5 if value == 0 else float(value > 0)
        votes[b, a] += share
        votes[a, b] += 1 - share
    return dict(votes)
