"""Excluding participants from the analysis by hand, and reinstating them.

It only affects the analysis: participants continue, keep their places and are paid. It does not
overrule exclusion rules.
"""

from collections.abc import Sequence
from datetime import datetime
from typing import Final

from sqlalchemy import Select, delete, func, select, update
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.researchers import AuditLine, Event, ExclusionDecision
from studyapp.database.tables.study_session import StudySession
from studyapp.researchers.audit import ERASED, log_change, read_reason

EVENTS: Final = {True: Event.EXCLUDED, False: Event.REINSTATED}


def decide_exclusion(
    database: Database, clock: Clock, number: int, *, excluded: bool, by: str, reason: str
) -> None:
    """Exclude the participant of study session `number` from the analysis, or reinstate them.

    Parameters
    ----------
    by : str
        The researcher's name; empty for the command line.

    Raises
    ------
    InputError
        If there is no such study session, its participant withdrew, there is no reason, or nothing
        would change.
    """
    reason = read_reason(reason)
    with database.writing() as session:
        _require_participant(session, number)
        if _is_excluded(session, number) is excluded:
            raise InputError(
                f"study session {number} is {'already' if excluded else 'not'} excluded by hand",
                remedy="Somebody else may have changed it",
            )
        now = clock.now()
        session.add(
            ExclusionDecision(
                at=now, study_session_id=number, excluded=excluded, researcher=by, reason=reason
            )
        )
        log_change(session, now, EVENTS[excluded], by=by, study_session=number, reason=reason)


def exclusion_decisions(session: Session, number: int) -> Sequence[ExclusionDecision]:
    """Return the decisions about study session `number`, the newest first."""
    query = (
        select(ExclusionDecision)
        .where(ExclusionDecision.study_session_id == number)
        .order_by(ExclusionDecision.id.desc())
    )
    return session.scalars(query).all()


def current_exclusions() -> Select[int, str, datetime]:
    """Select the participants excluded by hand: ``study_session_id``, ``reason`` and ``at``."""
    newest = select(func.max(ExclusionDecision.id)).group_by(ExclusionDecision.study_session_id)
    return select(
        ExclusionDecision.study_session_id, ExclusionDecision.reason, ExclusionDecision.at
    ).where(ExclusionDecision.id.in_(newest), ExclusionDecision.excluded)


def erase_decisions(session: Session, number: int) -> None:
    """Erase the decisions about study session `number`, and their reasons from the log."""
    session.execute(delete(ExclusionDecision).where(ExclusionDecision.study_session_id == number))
    session.execute(
        update(AuditLine)
        .where(AuditLine.event.in_(EVENTS.values()), AuditLine.study_session == number)
        .values(reason=ERASED)
    )


def _require_participant(session: Session, number: int) -> None:
    """Lock study session `number`; `InputError` if there is none, or its participant withdrew."""
    study_session = session.get(StudySession, number, with_for_update=True)
    if study_session is None:
        raise InputError(
            f"there is no study session {number}",
            remedy="The researchers' pages list all study sessions",
        )
    if study_session.withdrawn_at is not None:
        raise InputError(
            f"the participant of study session {number} has withdrawn",
            remedy="Answers of participants who withdrew are never analysed",
        )


def _is_excluded(session: Session, number: int) -> bool:
    return any(each.excluded for each in exclusion_decisions(session, number)[:1])
