"""Alarms: researchers are told once when the study is full, stalls, or fills from one address.

Each server process looks now and then. The one that stores an alarm first sends it, beside all
requests. What cannot be sent is forgotten, so that a later look tries again.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Final, Literal

from sqlalchemy import delete, func, select
from sqlalchemy.exc import IntegrityError, SQLAlchemyError
from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import Alarm, IntakeChange, StudySession, StudyVersion
from studyapp.session.arrival.intake import present_intake, wanted_places
from studyapp.session.arrival.newcomers import most_from_one_address, require_let_in, require_room
from studyapp.session.refusal import StudyFullError
from studyapp.session.served_study import ServedStudy

SECONDS_BETWEEN: Final = 60.0

LOG: Final = logging.getLogger("gunicorn.error")

Kind = Literal["full", "stalled", "one address"]


@dataclass(frozen=True, kw_only=True)
class Event:
    """What researchers are to be told; see `studyapp.database.tables.Alarm`."""

    kind: Kind
    about: str
    text: str


def watch_for_alarms(
    database: Database,
    served: ServedStudy,
    clock: Clock,
    send: Callable[[str], bool],
) -> None:
    """Look for alarms from a thread of its own, as long as the process lives."""

    def look_again_and_again() -> None:
        waits = threading.Event()
        while not waits.wait(SECONDS_BETWEEN):
            try:
                raise_alarms(database, served, clock, send)
            except SQLAlchemyError as error:
                LOG.error("Alarms could not be looked for (%s)", type(error).__name__)

    threading.Thread(target=look_again_and_again, name="alarms", daemon=True).start()


def raise_alarms(
    database: Database,
    served: ServedStudy,
    clock: Clock,
    send: Callable[[str], bool],
) -> None:
    """Send the alarms that are due and that nobody has sent.

    Parameters
    ----------
    send : callable
        Sends a text, and tells whether that succeeded.
    """
    now = clock.now()
    with database.reading() as session:
        due = list(_due(session, served, now))
        raised = {(row.kind, row.about) for row in session.scalars(select(Alarm))}
    for event in due:
        if (event.kind, event.about) in raised or not _claim(database, event, now):
            continue
        if not send(event.text):
            with database.writing() as session:
                own = (Alarm.kind == event.kind, Alarm.about == event.about)
                session.execute(delete(Alarm).where(*own))


def _claim(database: Database, event: Event, now: datetime) -> bool:
    """Store that `event` is being sent; False where another process has done so."""
    try:
        with database.writing() as session:
            session.add(Alarm(kind=event.kind, about=event.about, at=now))
    except IntegrityError:
        return False
    return True


def _due(session: Session, served: ServedStudy, now: datetime) -> Iterator[Event]:
    study = served.study
    most = most_from_one_address(session, now)
    if most >= study.alarms.from_one_address:
        yield Event(
            kind="one address",
            about=now.date().isoformat(),
            text=f"{most} participants of the study {study.title!r} came from one network "
            "address within an hour.",
        )
    intake = present_intake(session)
    try:
        require_let_in(served, intake)
    except StudyFullError:
        return
    version = session.scalars(select(StudyVersion).where(StudyVersion.in_force)).first()
    if version is None:
        return
    try:
        require_room(session, served, intake, now)
    except StudyFullError:
        places = sum(wanted_places(served, intake).values())
        yield Event(
            kind="full",
            about=f"version {version.number}, {places} places",
            text=f"The study {study.title!r} is full: all {places} places are held.",
        )
        return
    since = _last_progress(session, version)
    if now - since >= timedelta(hours=study.alarms.stalled_hours):
        yield Event(
            kind="stalled",
            about=since.isoformat(timespec="seconds"),
            text=f"The study {study.title!r} is open, and nobody has finished it for "
            f"{int((now - since).total_seconds() // 3600)} hours.",
        )


def _last_progress(session: Session, version: StudyVersion) -> datetime:
    """Return when somebody last finished, or newcomers were last decided about."""
    moments = (
        version.opened_at,
        session.scalar(select(func.max(StudySession.completed_at))),
        session.scalar(select(func.max(IntakeChange.at))),
    )
    return max(moment for moment in moments if moment is not None)
