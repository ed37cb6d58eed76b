"""Withdrawing: the place is given back, the answers are deleted or kept as was promised."""

from __future__ import annotations

import tomllib
from datetime import datetime
from typing import Literal

from sqlalchemy import delete
from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import FormAnswer, RefusalLine, StudySession, Trial
from studyapp.researchers.exclusion_decisions import erase_decisions
from studyapp.session.refusal import ConflictError
from studyapp.session.state import find, state_of
from studyapp.study.settings.page import Page

Promise = Literal["deleted", "kept"]
"""What becomes of the answers of who withdraws."""


def promise_made(database: Database, token: str) -> Promise:
    """Return what becomes of the participant's answers on withdrawing.

    Raises
    ------
    ConflictError
        If the study session is finished, or somebody unproven has gone on with it.
    """
    with database.reading() as session:
        study_session = find(session, token, to_change=False)
        _require_unfinished(study_session)
        return _promise(study_session)


def withdraw(database: Database, token: str, clock: Clock) -> None:
    """Take the consent back: the place is given back, and the answers are not exported.

    Withdrawing twice changes nothing.

    Raises
    ------
    ConflictError
        If the study session is finished, as its completion code may have been used; or if
        somebody went on with it who could not show that they had begun it.
    """
    with database.writing() as session:
        study_session = find(session, token)
        _require_unfinished(study_session)
        if study_session.withdrawn_at is None:
            take_back(session, study_session, clock.now())


def take_back(session: Session, study_session: StudySession, now: datetime) -> None:
    """End `study_session` as withdrawn.

    Where deletion was promised, all that is left is that somebody took part and withdrew: when,
    in which arm, and by which name the recruiter would send them again.
    """
    study_session.withdrawn_at = now
    study_session.place = None
    session.flush()
    if _promise(study_session) == "kept":
        return
    # What hangs on trials goes with them, in the database.
    session.execute(delete(Trial).where(Trial.study_session_id == study_session.id))
    session.execute(delete(FormAnswer).where(FormAnswer.study_session_id == study_session.id))
    erase_decisions(session, study_session.id)
    session.execute(delete(RefusalLine).where(RefusalLine.study_session_id == study_session.id))
    study_session.recruiter_session = study_session.submit_to = ""
    study_session.conditions = []
    study_session.number = None
    if study_session.sound_checked_at is not None:
        study_session.sound_tries = 0  # only who could not hear is told so afterwards
    study_session.started_at = study_session.sound_checked_at = None
    study_session.sound_digits = ""
    study_session.rested_at_position = None
    study_session.last_active_at = now
    session.flush()
    session.expire(study_session)


def _require_unfinished(study_session: StudySession) -> None:
    if study_session.unproven_at is not None and study_session.withdrawn_at is None:
        raise ConflictError(
            "This study was continued by somebody who only knew the participant's name, so nobody "
            "can withdraw here.",
            "To stop, just close this page. To have your answers removed, please write to the "
            "people who run the study.",
        )
    if state_of(study_session) == "completed":
        raise ConflictError(
            "You have already finished the study.",
            "To have your answers removed, please write to the people who run it.",
        )


def _promise(study_session: StudySession) -> Promise:
    """Return what the study promised when this participant agreed, not what it promises now."""
    page = tomllib.loads(study_session.version.definition).get("page", {})
    promised: Promise = page.get("withdrawn", Page.model_fields["withdrawn"].default)
    return promised
