"""Excluding single participants from the analysis by hand, and reinstating them.

It decides about the analysis alone: who is under way goes on, the place stays held, and whoever
has earned pay is paid. An exclusion rule of the study is not overruled by anything decided here.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from typing import Final

from sqlalchemy import Select, delete, func, select, update
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import AuditLine, Event, ExclusionDecision, StudySession
from studyapp.researchers.audit import ERASED, log_change, read_reason

EVENTS: Final = {True: Event.EXCLUDED, False: Event.REINSTATED}


def decide_exclusion(
    database: Database, clock: Clock, number: int, *, excluded: bool, by: str, reason: str
) -> None:
    """Leave the participant of study session `number` out of the analysis, or take them in again.

    Parameters
    ----------
    by : str
        The researcher's name; empty for the command line.

    Raises
    ------
    InputError
        If there is no such study session, its participant withdrew, no reason is given, or it is
        so already.
    """
    reason = read_reason(reason)
    with database.writing() as session:
        _require_participant(session, number)
        if _is_excluded(session, number) is excluded:
            raise InputError(
                f"study session {number} is {'' if excluded else 'not '}excluded already",
                remedy="Somebody else may have decided it",
            )
        now = clock.now()
        session.add(
            ExclusionDecision(
                at=now, study_session_id=number, excluded=excluded, researcher=by, reason=reason
            )
        )
        log_change(session, now, EVENTS[excluded], by=by, study_session=number, reason=reason)


def exclusion_decisions(session: Session, number: int) -> Sequence[ExclusionDecision]:
    """Return what was decided about study session `number`, the newest first."""
    query = (
        select(ExclusionDecision)
        .where(ExclusionDecision.study_session_id == number)
        .order_by(ExclusionDecision.id.desc())
    )
    return session.scalars(query).all()


def current_exclusions() -> Select[int, str, datetime]:
    """Select who is excluded by hand now: ``study_session_id``, ``reason`` and ``at``."""
    newest = select(func.max(ExclusionDecision.id)).group_by(ExclusionDecision.study_session_id)
    return select(
        ExclusionDecision.study_session_id, ExclusionDecision.reason, ExclusionDecision.at
    ).where(ExclusionDecision.id.in_(newest), ExclusionDecision.excluded)


def erase_decisions(session: Session, number: int) -> None:
    """Erase what was decided about study session `number`, and the reasons from the log."""
    session.execute(delete(ExclusionDecision).where(ExclusionDecision.study_session_id == number))
    session.execute(
        update(AuditLine)
        .where(AuditLine.event.in_(EVENTS.values()), AuditLine.study_session == number)
        .values(reason=ERASED)
    )


def _require_participant(session: Session, number: int) -> None:
    """Raise `InputError` unless there is somebody to decide about; keep other writers away."""
    found = session.scalars(
        select(StudySession).where(StudySession.id == number).with_for_update()
    ).first()
    if found is None:
        raise InputError(
            f"there is no study session {number}",
            remedy="The researchers' pages list those that there are",
        )
    if found.withdrawn_at is not None:
        raise InputError(
            f"the participant of study session {number} has withdrawn",
            remedy="Nothing of who withdrew is analysed in any case",
        )


def _is_excluded(session: Session, number: int) -> bool:
    return any(each.excluded for each in exclusion_decisions(session, number)[:1])
