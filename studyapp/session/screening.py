"""Screening: who is screened out, and how many people at which stage.

A screen-out is final for participants with a name or an invitation. The recruiter's screen-out
code is shown only once it is stored: nobody can get it, go back and change their answers.
Everybody else is only counted.
"""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from types import MappingProxyType
from typing import Final

from sqlalchemy import func, select, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import InstrumentedAttribute, Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import ScreenOut, StudyVersion
from studyapp.session.arrivals import Arrival
from studyapp.study.settings.questions import Stage

COUNTS: Final[Mapping[Stage, InstrumentedAttribute[int]]] = MappingProxyType(
    {
        "eligibility": StudyVersion.screened_by_eligibility,
        "consent": StudyVersion.screened_by_consent,
        "comprehension": StudyVersion.screened_by_comprehension,
    }
)
"""The column that counts screen-outs at each stage."""


def was_screened_out(database: Database, arrival: Arrival) -> bool:
    """Tell whether the arriving person was screened out before."""
    with database.reading() as session:
        return _is_stored(session, arrival.name)


def note_screen_out(
    database: Database, arrival: Arrival, stage: Stage, clock: Clock, *, named: bool
) -> None:
    """Count the arriving person as screened out at `stage`.

    Parameters
    ----------
    named : bool
        Whether to store their name, so that they stay screened out and are counted once.
    """
    try:
        with database.writing() as session:
            if not (named and _is_stored(session, arrival.name)):
                screen_out(session, arrival.name if named else None, stage, clock.now())
    except IntegrityError:
        pass  # the same person in another window, at the same moment


def screen_out(session: Session, name: str | None, stage: Stage, now: datetime) -> None:
    """Count a screen-out, and store the person's name if there is one."""
    if name is not None:
        session.add(ScreenOut(participant=name, screened_out_at=now))
        session.flush()
    count = COUNTS[stage]
    session.execute(
        update(StudyVersion).where(StudyVersion.in_force).values({count: count + 1}),
        execution_options={"synchronize_session": False},
    )


def count_screened_out(session: Session) -> dict[str, int]:
    """Count the screen-outs at each stage, in all versions of the study."""
    sums = [func.coalesce(func.sum(count), 0) for count in COUNTS.values()]
    return dict(zip(COUNTS, map(int, session.execute(select(*sums)).one()), strict=True))


def _is_stored(session: Session, name: str) -> bool:
    return session.scalar(select(ScreenOut.id).where(ScreenOut.participant == name)) is not None
