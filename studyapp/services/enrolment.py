"""Enrolment: a participant agrees, and gets a place and their trials; coming again resumes."""

from __future__ import annotations

import secrets
import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Final

from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.design.planned_trial import PlannedTrial
from studyapp.design.stimulus import Content
from studyapp.models import Place, StudySession, Trial, TrialStimulus, Video
from studyapp.services.database import Database
from studyapp.services.form_answers import entrance_answers
from studyapp.services.places import least_filled, release_stale, take_allocation_turn
from studyapp.services.refusal import StudyFullError
from studyapp.services.served_study import ServedStudy
from studyapp.services.sound_check import left_unheard
from studyapp.services.versions import present_version
from studyapp.services.votes import votes_so_far

TOKEN_BYTES: Final = 24
"""Random bytes of every token: 192 bits."""

ONE_ARRIVAL: Final = threading.Lock()
"""Who waits for the allocation's turn keeps a connection to the database. A process whose arrivals
all did would have none left for those who answer."""


@dataclass(frozen=True, kw_only=True)
class Arrival:
    """Who comes, as far as anybody says so.

    Attributes
    ----------
    visit : str or None
        Drawn with the consent page; the same one always means the same study session.
    recruiter_participant : str or None
        The recruiter's name for the participant, who takes part once in each of the
        recruiter's studies.
    recruiter_study, recruiter_session : str
        The recruiter's names for the study and the sitting; may be empty.
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
        If no place is open.
    UnacceptableError, IneligibleError
        If the answers under eligibility and consent do not let them take part.
    """
    with ONE_ARRIVAL, database.writing() as session:
        return _enrol(session, served, arrival, clock.now())


def enrolled(database: Database, arrival: Arrival) -> str | None:
    """Return the token of the study session that the arriving participant comes back to, if any."""
    with database.reading() as session:
        known = session.scalars(select(StudySession).where(_is_same(arrival))).first()
        return None if known is None or left_unheard(known) else known.token


def _enrol(session: Session, served: ServedStudy, arrival: Arrival, now: datetime) -> str:
    take_allocation_turn(session)
    known = session.scalars(select(StudySession).where(_is_same(arrival))).first()
    if known is not None and not left_unheard(known):
        return known.token
    if not served.study.open:
        raise StudyFullError(
            "The study takes no new participants at the moment.",
            "Thank you for your interest. You can try later with the same link.",
        )
    answers = entrance_answers(served.study, arrival.form, now)
    release_stale(session, served, now)
    place = least_filled(session, served)
    if place is None:
        raise StudyFullError(
            "The study has all the participants it needs at the moment.",
            "Thank you for your interest. A place may open again: you can try later with the "
            "same link.",
        )
    if known is not None:
        session.delete(known)
        session.flush()  # no two study sessions may have the same name
    study_session = StudySession(
        token=secrets.token_urlsafe(TOKEN_BYTES),
        visit=arrival.visit,
        recruiter_participant=arrival.recruiter_participant,
        recruiter_study=arrival.recruiter_study,
        recruiter_session=arrival.recruiter_session,
        version=present_version(session, served),
        arm=place.arm,
        arm_design=place.design,
        number=place.number,
        conditions=list(served.arms[place.arm, place.design].conditions),
        consented_at=now,
        last_active_at=now,
        trials=_trials(session, served, place),
        form_answers=answers,
    )
    session.add(study_session)
    place.study_session = study_session
    session.flush()
    return study_session.token


def _is_same(arrival: Arrival) -> ColumnElement[bool]:
    if arrival.recruiter_participant is None:
        return StudySession.visit == arrival.visit
    return (StudySession.recruiter_participant == arrival.recruiter_participant) & (
        StudySession.recruiter_study == arrival.recruiter_study
    )


def _trials(session: Session, served: ServedStudy, place: Place) -> list[Trial]:
    arm = served.arms[place.arm, place.design]
    votes = votes_so_far(session, served)
    planned = served.study.plan(arm, place.number, served.segments, votes)
    return [_trial(served, trial) for trial in planned]


def _trial(served: ServedStudy, planned: PlannedTrial) -> Trial:
    trial = Trial(
        token=secrets.token_urlsafe(TOKEN_BYTES),
        position=planned.position,
        kind=planned.kind,
        part=planned.part,
        segment=planned.segment.name,
        emotion=planned.segment.emotion,
        speaker=planned.segment.speaker,
        expected=planned.expected,
        instructed=planned.instructed,
        repeats=planned.repeats,
    )
    shown = 0
    for number, content in enumerate(planned.videos, start=1):
        _show(trial, served, content, video=number, first=shown + 1)
        shown += len(content)
    if planned.reference is not None:
        _show(trial, served, (planned.reference,), video=0, first=0)
    return trial


def _show(trial: Trial, served: ServedStudy, content: Content, *, video: int, first: int) -> None:
    """Add a video to `trial` and what it shows, counted from `first`."""
    player = Video(
        number=video,
        token=secrets.token_urlsafe(TOKEN_BYTES),
        duration=served.videos[content].duration,
    )
    trial.videos.append(player)
    for number, stimulus in enumerate(content, start=first):
        trial.stimuli.append(
            TrialStimulus(
                video=player,
                number=number,
                condition=stimulus.condition,
                segment=stimulus.segment,
                speech=stimulus.speech,
            )
        )
