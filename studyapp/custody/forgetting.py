"""Forgetting a participant: all that is stored of one person is erased."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Final, cast

from sqlalchemy import JSON, Column, Table, delete, func, select, update
from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import (
    AuditLine,
    Base,
    Event,
    FormAnswer,
    InterimFigures,
    Look,
    RefusalLine,
    Response,
    ScreenOut,
    StudySession,
    Trial,
    Video,
    WatchRecord,
)
from studyapp.researchers.audit import ERASED, log_change
from studyapp.researchers.exclusion_decisions import erase_decisions
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.session.state import state_of
from studyapp.session.trial_rows import new_token

LEFT: Final = frozenset({"id", "version_id", "arm", "arm_design"})
"""Columns of a study session that stay: they are of the study, not of the person. All others are
emptied, so that a column that is added later is erased unless somebody decides otherwise."""

GIVEN_BACK: Final = frozenset({"places"})
"""Tables whose rows belong to the study: they lose the participant. In all other tables, what
belongs to the study session is deleted."""

SHORTEST_NAME: Final = 4
"""Shorter names are not looked for in the log: too much else would be replaced."""

SESSIONS: Final = cast(Table, StudySession.__table__)


@dataclass(frozen=True, kw_only=True)
class Remembered:
    """What is stored of one person's coming, for whoever decides whether to erase it.

    Attributes
    ----------
    study_session : int or None
        Its number, which the report and the exports name it by; None of who was screened out
        and has none.
    arm, state : str
        See `studyapp.session.state.state_of`; or ``screened out``.
    answers, form_answers, watch_records, refusals : int
        How many rows of each there are.
    known_as : str
        What the participant was named by: ``recruiter id``, ``pseudonym`` or
        ``completion code``.
    """

    study_session: int | None
    arm: str
    state: str
    known_as: str
    answers: int = 0
    form_answers: int = 0
    watch_records: int = 0
    refusals: int = 0


def remembered(database: Database, name: str, key: PseudonymKey | None) -> tuple[Remembered, ...]:
    """Return what is stored of the participant called `name`; nothing where there is none.

    Parameters
    ----------
    name : str
        The recruiter's name for the participant, the pseudonym, or the completion code. Who came
        in two of the recruiter's studies has two study sessions.
    key : PseudonymKey or None
        By which pseudonyms are found; None where nothing was ever exported.
    """
    with database.reading() as session:
        study_sessions = [
            Remembered(
                study_session=found.id,
                arm=found.arm,
                state=state_of(found),
                known_as=known_as,
                **_counts(session, found.id),
            )
            for found, known_as in _called(session, name, key)
        ]
        screened_out = session.scalars(select(ScreenOut.id).where(ScreenOut.participant == name))
        return (
            *study_sessions,
            *(
                Remembered(
                    study_session=None, arm="", state="screened out", known_as="recruiter id"
                )
                for _ in screened_out
            ),
        )


def forget(database: Database, name: str, key: PseudonymKey | None, clock: Clock) -> int:
    """Erase the participant called `name`, in one transaction.

    Answers, trials, watch evidence, form answers, refusals, tokens, codes and the recruiter's
    names go; the place is given back. One row stays, as of who withdrew: that there was a study
    session in this arm, which is gone, and when it was erased. A line in the log says so without
    a name; names that stand in earlier lines are replaced. Forgetting twice changes nothing.

    What the participant sends meanwhile either comes before, and is erased, or is refused: the
    address belongs to nobody any more. `studyapp.database.scrubbing.scrub` is to be
    called after it.

    Parameters
    ----------
    name, key
        See `remembered`.

    Returns
    -------
    int
        How many entries of `remembered` were erased.
    """
    with database.writing() as session:
        now = clock.now()
        found = _called(session, name, key, to_change=True)
        for study_session, _ in found:
            erase(session, study_session, key, now)
        screened_out = _erase_screen_outs(session, [name])
        if screened_out and not found:
            log_change(session, now, Event.FORGOTTEN, by="", detail="was screened out")
        return len(found) + screened_out


def has_forgotten(database: Database) -> bool:
    """Tell whether anybody was ever erased, so that the files may hold what was deleted."""
    with database.reading() as session:
        lines = select(AuditLine.id).where(AuditLine.event == Event.FORGOTTEN).limit(1)
        return session.scalars(lines).first() is not None


def _called(
    session: Session, name: str, key: PseudonymKey | None, *, to_change: bool = False
) -> list[tuple[StudySession, str]]:
    query = select(StudySession).order_by(StudySession.id)
    everybody = list(session.scalars(query))
    # One code or pseudonym is of one study session; the person may have several.
    persons = {
        study_session.recruiter_participant: found
        for study_session in everybody
        if (found := _known_as(study_session, name, key))
    }

    def known_as(study_session: StudySession) -> str:
        own = _known_as(study_session, name, key)
        recruited = study_session.recruiter_participant
        return own or ("" if recruited is None else persons.get(recruited, ""))

    chosen = [study_session.id for study_session in everybody if known_as(study_session)]
    wanted = query.where(StudySession.id.in_(chosen))
    if to_change:
        wanted = wanted.with_for_update().execution_options(populate_existing=True)
    return [
        (study_session, known_as(study_session))
        for study_session in session.scalars(wanted)
        # Whoever else was forgetting them may have been first.
        if known_as(study_session)
    ]


def _known_as(study_session: StudySession, name: str, key: PseudonymKey | None) -> str:
    if not name:
        return ""
    if study_session.recruiter_participant == name:
        return "recruiter id"
    if study_session.completion_code == name:
        return "completion code"
    if key is not None and key.is_called(study_session, name):
        return "pseudonym"
    return ""


def _counts(session: Session, number: int) -> dict[str, int]:
    def count(query: Any) -> int:
        return session.scalar(query) or 0

    trials = Trial.study_session_id == number
    return {
        "answers": count(select(func.count(Response.id)).join(Response.trial).where(trials)),
        "watch_records": count(
            select(func.count(WatchRecord.id))
            .join(WatchRecord.video)
            .join(Video.trial)
            .where(trials)
        ),
        "form_answers": count(
            select(func.count(FormAnswer.id)).where(FormAnswer.study_session_id == number)
        ),
        "refusals": count(
            select(func.count(RefusalLine.id)).where(RefusalLine.study_session_id == number)
        ),
    }


def erase(
    session: Session,
    study_session: StudySession,
    key: PseudonymKey | None,
    now: datetime,
) -> None:
    """Erase `study_session` as `forget` does, within the transaction of `session`."""
    number, arm, state = study_session.id, study_session.arm, state_of(study_session)
    # By an invitation, the visit is what stands for its holder.
    known_as = [study_session.recruiter_participant, study_session.visit]
    _erase_screen_outs(session, [name for name in known_as if name])
    _erase_names(session, _names(study_session, key))
    erase_decisions(session, number)
    # What few participants answered shows through what was computed of it.
    session.execute(delete(InterimFigures))
    for table, column in _belonging():
        if table.name in GIVEN_BACK:
            session.execute(update(table).where(column == number).values({column.name: None}))
        else:
            # What hangs on these rows goes with them, in the database.
            session.execute(delete(table).where(column == number))
    session.execute(
        update(SESSIONS).where(SESSIONS.c.id == number).values(_emptied(now, new_token()))
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
    """Delete that somebody was screened out, and return how often that was stored."""
    chosen = ScreenOut.participant.in_(names)
    count = session.scalar(select(func.count(ScreenOut.id)).where(chosen)) or 0
    session.execute(delete(ScreenOut).where(chosen))
    return count


def _names(study_session: StudySession, key: PseudonymKey | None) -> Iterator[str]:
    for name in (
        study_session.recruiter_participant,
        study_session.recruiter_session,
        study_session.completion_code,
        None if key is None else key.pseudonym(study_session),
    ):
        if name is not None and len(name) >= SHORTEST_NAME:
            yield name


def _erase_names(session: Session, names: Iterator[str]) -> None:
    """Replace names in earlier lines of the log; what was done, and by whom, stays."""
    for name in names:
        for look in session.scalars(
            select(Look).where(Look.reason.contains(name, autoescape=True))
        ):
            look.reason = look.reason.replace(name, ERASED)
        for line in session.scalars(
            select(AuditLine).where(
                AuditLine.detail.contains(name, autoescape=True)
                | AuditLine.reason.contains(name, autoescape=True)
            )
        ):
            line.detail = line.detail.replace(name, ERASED)
            line.reason = line.reason.replace(name, ERASED)


def _belonging() -> list[tuple[Table, Column[Any]]]:
    """Return every table that names study sessions, and the column that does."""
    return [
        (table, key.parent)
        for table in Base.metadata.sorted_tables
        for key in table.foreign_keys
        if key.column.table is SESSIONS
    ]


def _emptied(now: datetime, token: str) -> dict[str, Any]:
    """Return what stands in a forgotten study session."""
    values: dict[str, Any] = {
        "token": token,
        "consented_at": now,
        "last_active_at": now,
        "withdrawn_at": now,
    }
    for column in SESSIONS.columns:
        if column.name in LEFT or column.name in values:
            continue
        values[column.name] = None if column.nullable else _empty_of(column, now)
    return values


def _empty_of(column: Column[Any], now: datetime) -> object:
    """Return the emptiest value that a column can hold which must hold one."""
    if isinstance(column.type, JSON):
        return []
    kind = column.type.python_type
    return now if kind is datetime else kind()
