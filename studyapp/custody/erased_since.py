"""Whom a later state of a study's database no longer holds, so that a backup holds them no longer.

A backup is older than what happened after it: who was forgotten since is in it, and so is what was
deleted of those who withdrew. Wherever the later state is still at hand, both are done again.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.custody.forgetting import erase
from studyapp.database.engine import Database
from studyapp.database.tables import AuditLine, Event, ScreenOut, StudySession, StudyVersion
from studyapp.researchers.audit import log_change
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.session.withdrawal import take_back


@dataclass(frozen=True, kw_only=True)
class ErasedAgain:
    """What was erased again.

    Attributes
    ----------
    forgotten, withdrawn : int
        Study sessions.
    screened_out : int
        How many people of whom it was stored that they were screened out.
    """

    forgotten: int = 0
    withdrawn: int = 0
    screened_out: int = 0


@dataclass(frozen=True, kw_only=True)
class _Later:
    """What the later state says of those who came.

    Attributes
    ----------
    tokens : mapping of int to str
        By the number of the study session; forgetting draws another one.
    withdrawn : mapping of int to datetime
    forgotten : frozenset of int
        Numbers of study sessions, from the log.
    screened_out : frozenset of int
        Ids of the rows there are.
    versions : frozenset of datetime
        When each version of the study was opened; no two studies agree in that.
    log : frozenset of (int, datetime, str)
        Number, moment and event of each line; lines are only ever added.
    """

    tokens: dict[int, str]
    withdrawn: dict[int, datetime]
    forgotten: frozenset[int]
    screened_out: frozenset[int]
    versions: frozenset[datetime]
    log: frozenset[tuple[int, datetime, str]]


def erase_again(
    restored: Database, later: Database, key: PseudonymKey | None, clock: Clock
) -> ErasedAgain:
    """Erase from `restored` whom `later` has forgotten, and what it deleted of who withdrew.

    Parameters
    ----------
    restored : Database
        An earlier state of the same study.
    later : Database
        Read only.
    key : PseudonymKey or None
        See `studyapp.custody.forgetting.forget`.

    Raises
    ------
    InputError
        If `later` is of another study.
    """
    known = _read(later)
    with restored.writing() as session:
        _require_same_study(session, known)
        now = clock.now()
        forgotten = withdrawn = 0
        for study_session in list(session.scalars(select(StudySession).order_by(StudySession.id))):
            number = study_session.id
            is_same = known.tokens.get(number) == study_session.token
            # Forgetting draws another token; who was forgotten before has that one here too.
            if number in known.forgotten and not is_same:
                erase(session, study_session, key, now)
                forgotten += 1
            elif is_same and number in known.withdrawn and study_session.withdrawn_at is None:
                take_back(session, study_session, known.withdrawn[number])
                withdrawn += 1
        gone = [
            each for each in session.scalars(select(ScreenOut.id)) if each not in known.screened_out
        ]
        session.execute(delete(ScreenOut).where(ScreenOut.id.in_(gone)))
        return ErasedAgain(forgotten=forgotten, withdrawn=withdrawn, screened_out=len(gone))


def note_restored(database: Database, detail: str, clock: Clock) -> None:
    """Say in the log of `database` that it was restored."""
    with database.writing() as session:
        log_change(session, clock.now(), Event.RESTORED, by="", detail=detail)


def _read(later: Database) -> _Later:
    with later.reading() as session:
        sittings = session.execute(
            select(StudySession.id, StudySession.token, StudySession.withdrawn_at)
        ).all()
        forgotten = session.scalars(
            select(AuditLine.study_session).where(AuditLine.event == Event.FORGOTTEN)
        )
        return _Later(
            tokens={each.id: each.token for each in sittings},
            withdrawn={
                each.id: each.withdrawn_at for each in sittings if each.withdrawn_at is not None
            },
            forgotten=frozenset(number for number in forgotten if number is not None),
            screened_out=frozenset(session.scalars(select(ScreenOut.id))),
            versions=frozenset(session.scalars(select(StudyVersion.opened_at))),
            log=_log(session),
        )


def _log(session: Session) -> frozenset[tuple[int, datetime, str]]:
    lines = session.execute(select(AuditLine.id, AuditLine.at, AuditLine.event))
    return frozenset((line.id, line.at, line.event) for line in lines)


def _require_same_study(session: Session, known: _Later) -> None:
    """Raise `InputError` unless the later state has all that this one's study went through.

    Numbers of study sessions mean the same people only as long as one state follows from the other.
    Of two studies that went on from one backup, each has a line in the log that the other lacks.
    """
    seen = select(StudyVersion.opened_at).where(
        StudyVersion.id.in_(select(StudySession.version_id))
    )
    if not (set(session.scalars(seen)) <= known.versions and _log(session) <= known.log):
        raise InputError(
            "that is not a later state of the study in this backup",
            where="--forgotten-in",
            remedy="Name a later backup of the same study, served on from the same folder",
        )
