"""Versions of the study: its design may not change while data are collected, unless asked to."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.definition.versioning import operation_changes, operation_part
from studyapp.models import AuditLine, Place, StudySession, StudyVersion
from studyapp.services.database import Database
from studyapp.services.places import open_places, release_outdated, take_allocation_turn
from studyapp.services.refusal import ConflictError
from studyapp.services.served_study import ServedStudy

OPERATION_CHANGED = "operation changed"

UNKNOWN_DESIGN = ""
"""Of data that were collected before designs were noted."""


def open_study(
    database: Database, served: ServedStudy, clock: Clock, *, new_version: bool = False
) -> None:
    """Make the database ready for `served`: its version is noted, and its places are open.

    Parameters
    ----------
    new_version : bool
        Whether a changed design may become a new version.

    Raises
    ------
    InputError
        If somebody has taken part in another design, and `new_version` is not given.
    """
    with database.writing() as session:
        take_allocation_turn(session)
        _open(session, served, clock.now(), new_version=new_version)


def present_version(session: Session, served: ServedStudy) -> StudyVersion:
    """Return the version that `served` is of; `open_study` has noted it.

    Raises
    ------
    ConflictError
        If another server process has opened a changed study since, and nobody had come to this
        one.
    """
    known = session.scalars(
        select(StudyVersion).where(StudyVersion.design == served.design)
    ).first()
    if known is None:
        raise ConflictError(
            "The study has just been changed, and this page is of the one before.",
            "Please try again in a few minutes with the same link.",
        )
    return known


def _open(session: Session, served: ServedStudy, now: datetime, *, new_version: bool) -> None:
    versions = list(session.scalars(select(StudyVersion).order_by(StudyVersion.number)))
    known = next((version for version in versions if version.design == served.design), None)
    if known is None:
        known = _note(session, served, versions, now, new_version=new_version)
    elif not _was_seen(session, known):
        # Whoever comes first is to find the exclusion rules of now, not those of the first opening.
        known.definition = served.definition
    _note_operation(session, served, known, now)
    release_outdated(session, served)
    open_places(session, served)


def _note(
    session: Session,
    served: ServedStudy,
    versions: list[StudyVersion],
    now: datetime,
    *,
    new_version: bool,
) -> StudyVersion:
    """Return a version for a design that is not known yet."""
    last = versions[-1] if versions else None
    if last is not None and last.design == UNKNOWN_DESIGN:
        return _adopt(session, served, last, now)
    if last is not None and not _was_seen(session, last):
        session.delete(last)
        session.flush()
        last = versions[-2] if len(versions) > 1 else None
    elif last is not None and not new_version:
        raise InputError(
            "the study's design has changed, and people have taken part in the one before",
            where="study.toml",
            remedy="Undo the change (the database keeps the file as it was), or serve it with "
            "--new-version: earlier answers are kept apart, and unfinished participants of what "
            "has changed cannot go on",
        )
    made = StudyVersion(
        number=1 if last is None else last.number + 1,
        design=served.design,
        definition=served.definition,
        operation=operation_part(served.study),
        opened_at=now,
    )
    session.add(made)
    session.flush()
    if made.number > 1:
        session.add(AuditLine(at=now, event="new version", detail=f"version {made.number}"))
    return made


def _was_seen(session: Session, version: StudyVersion) -> bool:
    """Tell whether anybody has enrolled in `version`."""
    seen = select(StudySession.id).where(StudySession.version_id == version.id).limit(1)
    return session.scalars(seen).first() is not None


def _adopt(
    session: Session, served: ServedStudy, version: StudyVersion, now: datetime
) -> StudyVersion:
    """Take what was collected before designs were noted for answers to the present design."""
    version.design, version.definition = served.design, served.definition
    version.operation = operation_part(served.study)
    for name, design in served.arms:
        session.execute(
            update(Place)
            .where(Place.arm == name, Place.design == UNKNOWN_DESIGN)
            .values(design=design)
        )
        session.execute(
            update(StudySession)
            .where(StudySession.arm == name, StudySession.arm_design == UNKNOWN_DESIGN)
            .values(arm_design=design)
        )
    session.add(
        AuditLine(
            at=now,
            event="design noted",
            detail="answers from before designs were noted are taken for the present one",
        )
    )
    session.flush()
    return version


def _note_operation(
    session: Session, served: ServedStudy, version: StudyVersion, now: datetime
) -> None:
    operation = operation_part(served.study)
    changes = operation_changes(version.operation, operation)
    if changes:
        session.add(AuditLine(at=now, event=OPERATION_CHANGED, detail="; ".join(changes)))
        version.operation = operation
        session.flush()
