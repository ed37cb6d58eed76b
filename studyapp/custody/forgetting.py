"""Erasing all data of a participant."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Final, cast

from sqlalchemy import JSON, Column, ColumnElement, Table, delete, func, select, update
from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.base import Base
from studyapp.database.tables.researchers import (
    AuditLine,
    Event,
    ExclusionDecision,
    InterimFigures,
    Look,
    ResearcherLogin,
)
from studyapp.database.tables.study_session import (
    IntakeChange,
    ScreenOut,
    StudySession,
)
from studyapp.researchers.audit import ERASED, log_change
from studyapp.researchers.credentials import token_hash
from studyapp.researchers.exclusion_decisions import erase_decisions
from studyapp.researchers.pseudonyms import PseudonymKey, fold_name
from studyapp.session.state import state_of
from studyapp.session.trials import new_token

KEPT_COLUMNS: Final = frozenset({"id", "version_id", "arm", "arm_design"})
"""Columns of a study session that describe the study, not the person. All others are cleared, so a
column that is added later is erased unless somebody decides otherwise."""

RELEASED_TABLES: Final = frozenset({"places"})
"""Tables whose rows belong to the study and only lose the participant. In other tables, the rows of
the study session are deleted."""

FREE_TEXTS: Final = (
    AuditLine.detail,
    AuditLine.reason,
    ExclusionDecision.reason,
    IntakeChange.reason,
    Look.reason,
    ResearcherLogin.unblinding_reason,
)
"""Columns in which researchers may have named a participant."""

MIN_NAME_LENGTH: Final = 4
"""Shorter names are not replaced in free text: they could be part of other words."""

SESSIONS: Final = cast(Table, StudySession.__table__)


@dataclass(frozen=True, kw_only=True)
class StoredData:
    """The stored data of one study session or screen-out, for those who decide on its erasure.

    Attributes
    ----------
    study_session : int or None
        Its number in reports and exports; None for a participant who was screened out.
    state : str
        See `studyapp.session.state.state_of`, or ``screened out``.
    arm : str
        Empty for a participant who was screened out.
    answers : int
        The number of stored answers to trials.
    """

    study_session: int | None
    state: str
    arm: str = ""
    answers: int = 0


def find_data(database: Database, name: str, key: PseudonymKey | None) -> tuple[StoredData, ...]:
    """Return the stored data of a participant; empty if there is none.

    Parameters
    ----------
    name : str
        The recruiter's id of the participant, the pseudonym, the completion code, or the link of
        the invitation.
    key : PseudonymKey or None
        Resolves pseudonyms; None if nothing was ever exported.
    """
    with database.reading() as session:
        study_sessions = [
            StoredData(
                study_session=study_session.id,
                arm=study_session.arm,
                state=state_of(study_session),
                answers=sum(len(trial.responses) for trial in study_session.trials),
            )
            for study_session in _find_sessions(session, name, key)
        ]
        screened_out = session.scalars(select(ScreenOut.id).where(_is_screen_out_of([name])))
        return (
            *study_sessions,
            *(StoredData(study_session=None, state="screened out") for _ in screened_out),
        )


def forget(database: Database, name: str, key: PseudonymKey | None, clock: Clock) -> int:
    """Erase a participant in one transaction.

    This deletes answers, trials, records of watching, form answers, refusals, tokens, codes and
    the recruiter's ids, and releases the place. One row remains, as for participants who withdrew:
    that a study session in this arm was erased, and when. A line in the log says so without a
    name, and names in what researchers wrote are replaced. Erasing twice changes nothing.

    A request that the participant sends meanwhile is either erased too or refused, since its
    address no longer exists. Call `studyapp.database.scrubbing.scrub` afterwards.

    Parameters
    ----------
    name, key
        See `find_data`.

    Returns
    -------
    int
        The number of erased entries of `find_data`.
    """
    with database.writing() as session:
        now = clock.now()
        study_sessions = _find_sessions(session, name, key, for_update=True)
        screened_out = _erase_screen_outs(session, [name])
        if study_sessions or screened_out:
            # Of an invitation only a hash is stored, so its link and token are known only here.
            _erase_names(session, [name.strip(), _token(name)])
        for study_session in study_sessions:
            erase(session, study_session, key, now)
        if screened_out and not study_sessions:
            log_change(session, now, Event.FORGOTTEN, by="", detail="was screened out")
        return len(study_sessions) + screened_out


def has_forgotten(database: Database) -> bool:
    """Return whether anybody was ever erased, so that files may still hold deleted data."""
    with database.reading() as session:
        lines = select(AuditLine.id).where(AuditLine.event == Event.FORGOTTEN).limit(1)
        return session.scalars(lines).first() is not None


def _find_sessions(
    session: Session, name: str, key: PseudonymKey | None, *, for_update: bool = False
) -> list[StudySession]:
    """Return the study sessions of the person called `name`."""
    query = select(StudySession).order_by(StudySession.id)
    matching = [each.id for each in session.scalars(query) if _is_called(each, name, key)]
    query = query.where(StudySession.id.in_(matching))
    if for_update:
        query = query.with_for_update().execution_options(populate_existing=True)
    # Another request may have erased them in the meantime.
    return [each for each in session.scalars(query) if _is_called(each, name, key)]


def _is_called(study_session: StudySession, name: str, key: PseudonymKey | None) -> bool:
    names = (study_session.recruiter_participant, study_session.completion_code)
    folded = fold_name(name)
    return study_session.visit == _visit(name) or (
        bool(folded)
        and (
            folded in (fold_name(each) for each in names if each)
            or (key is not None and key.is_called(study_session, folded))
        )
    )


def _visit(link: str) -> str:
    """Return what is stored of whoever has the invitation `link`, or only its token."""
    return token_hash(_token(link))


def _token(link: str) -> str:
    return link.strip().rpartition("invitation=")[2]


def erase(
    session: Session,
    study_session: StudySession,
    key: PseudonymKey | None,
    now: datetime,
) -> None:
    """Erase `study_session` as in `forget`, within the transaction of `session`."""
    number, arm, state = study_session.id, study_session.arm, state_of(study_session)
    # With an invitation, the visit identifies its holder.
    ids = [study_session.recruiter_participant, study_session.visit]
    _erase_screen_outs(session, [name for name in ids if name])
    _erase_names(session, _names(study_session, key))
    erase_decisions(session, number)
    # Figures computed from few participants reveal their answers.
    session.execute(delete(InterimFigures))
    for table, column in _referring_columns():
        if table.name in RELEASED_TABLES:
            session.execute(update(table).where(column == number).values({column.name: None}))
        else:
            # The database deletes dependent rows.
            session.execute(delete(table).where(column == number))
    session.execute(
        update(SESSIONS).where(SESSIONS.c.id == number).values(_cleared_values(now, new_token()))
    )
    session.expire(study_session)
    log_change(
        session,
        now,
        Event.FORGOTTEN,
        by="",
        study_session=number,
        detail=f"arm {arm}, was {state}",
    )
    session.flush()


def _erase_screen_outs(session: Session, names: Sequence[str]) -> int:
    """Delete the screen-outs of a participant and return their number."""
    matching = _is_screen_out_of(names)
    count = session.scalar(select(func.count(ScreenOut.id)).where(matching)) or 0
    session.execute(delete(ScreenOut).where(matching))
    return count


def _is_screen_out_of(names: Sequence[str]) -> ColumnElement[bool]:
    stored = [*map(fold_name, names), *map(_visit, names)]
    return func.lower(ScreenOut.participant).in_(stored)


def _names(study_session: StudySession, key: PseudonymKey | None) -> Iterator[str]:
    yield study_session.recruiter_participant or ""
    yield study_session.recruiter_session
    yield study_session.completion_code or ""
    if key is not None:
        yield key.pseudonym(study_session)


def _erase_names(session: Session, names: Iterable[str]) -> None:
    """Replace names in what researchers wrote; the events and their authors stay."""
    for name in names:
        if len(name) < MIN_NAME_LENGTH:
            continue
        pattern = re.compile(re.escape(name), re.IGNORECASE)
        for column in FREE_TEXTS:
            naming = select(column.class_).where(column.icontains(name, autoescape=True))
            for row in session.scalars(naming):
                setattr(row, column.key, pattern.sub(ERASED, getattr(row, column.key)))


def _referring_columns() -> list[tuple[Table, Column[Any]]]:
    """Return every table that refers to study sessions, with its foreign key."""
    return [
        (table, key.parent)
        for table in Base.metadata.sorted_tables
        for key in table.foreign_keys
        if key.column.table is SESSIONS
    ]


def _cleared_values(now: datetime, token: str) -> dict[str, Any]:
    """Return the values of an erased study session."""
    values: dict[str, Any] = {
        "token": token,
        "consented_at": now,
        "last_active_at": now,
        "withdrawn_at": now,
    }
    return values | {
        column.name: None if column.nullable else _empty_value(column, now)
        for column in SESSIONS.columns
        if column.name not in KEPT_COLUMNS | values.keys()
    }


def _empty_value(column: Column[Any], now: datetime) -> object:
    """Return the emptiest value of a column that cannot be null."""
    if isinstance(column.type, JSON):
        return []
    kind = column.type.python_type
    return now if kind is datetime else kind()
