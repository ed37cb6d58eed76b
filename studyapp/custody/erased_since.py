"""Whom a later state of a study's database no longer holds, so that a backup holds them no longer.

A backup is older than what happened after it: who was forgotten since is in it, and so is what was
deleted of those who withdrew. Wherever there still is the later state, both are done again.
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
from studyapp.session.ending import take_back


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
    with later.reading() as known, restored.writing() as session:
        _require_same_study(session, known)
        there = {each.id: each for each in known.scalars(select(StudySession))}
        forgotten = set(
            known.scalars(select(AuditLine.study_session).where(AuditLine.event == Event.FORGOTTEN))
        )
        now = clock.now()
        again = withdrawn = 0
        for study_session in list(session.scalars(select(StudySession).order_by(StudySession.id))):
            same = there.get(study_session.id)
            # Forgetting draws another token; who was forgotten before has that one here too.
            if same is not None and same.token != study_session.token:
                same = None
            if study_session.id in forgotten and same is None:
                erase(session, study_session, key, now)
                again += 1
            elif same is not None and same.withdrawn_at and study_session.withdrawn_at is None:
                take_back(session, study_session, same.withdrawn_at)
                withdrawn += 1
        kept = set(known.scalars(select(ScreenOut.id)))
        gone = [each for each in session.scalars(select(ScreenOut.id)) if each not in kept]
        session.execute(delete(ScreenOut).where(ScreenOut.id.in_(gone)))
        return ErasedAgain(forgotten=again, withdrawn=withdrawn, screened_out=len(gone))


def note_restored(database: Database, detail: str, clock: Clock) -> None:
    """Say in the log of `database` that it was restored."""
    with database.writing() as session:
        log_change(session, clock.now(), Event.RESTORED, by="", detail=detail)


def _log(session: Session) -> set[tuple[int, datetime, str]]:
    """Return number, moment and event of each line of the log; lines are only ever added."""
    lines = session.execute(select(AuditLine.id, AuditLine.at, AuditLine.event))
    return {(line.id, line.at, line.event) for line in lines}


def _require_same_study(session: Session, known: Session) -> None:
    """Raise `InputError` unless the later state has all that this one's study went through.

    Numbers of study sessions mean the same people only as long as one state follows from the other.
    Of two studies that went on from one backup, each has a line in the log that the other lacks.
    """
    seen = select(StudyVersion.opened_at).where(
        StudyVersion.id.in_(select(StudySession.version_id))
    )
    # When each version was opened: no two studies agree in that.
    opened = set(known.scalars(select(StudyVersion.opened_at)))
    if not (set(session.scalars(seen)) <= opened and _log(session) <= _log(known)):
        raise InputError(
            "that is not a later state of the study in this backup",
            where="--forgotten-in",
            remedy="Name a later backup of the same study, served on from the same folder",
        )
