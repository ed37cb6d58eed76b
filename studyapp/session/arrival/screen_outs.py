"""Who was screened out stays so, where somebody sent them by name.

The code that a recruiter wants for it is shown only once this is stored: nobody gets it and then
goes back and answers otherwise.
"""

from __future__ import annotations

from sqlalchemy import select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables import ScreenOut
from studyapp.session.arrival.enrolment import Arrival


def was_screened_out(database: Database, arrival: Arrival) -> bool:
    """Tell whether the arriving person was screened out before."""
    with database.reading() as session:
        return _found(session, arrival) is not None


def note_screen_out(database: Database, arrival: Arrival, clock: Clock) -> None:
    """Store that the arriving person was screened out; doing so twice changes nothing."""
    try:
        with database.writing() as session:
            if _found(session, arrival) is None:
                name = _name(arrival)
                session.add(ScreenOut(participant=name, screened_out_at=clock.now()))
    except IntegrityError:
        pass  # the same person in another window, at the same moment


def _found(session: Session, arrival: Arrival) -> ScreenOut | None:
    return session.scalars(select(ScreenOut).where(ScreenOut.participant == _name(arrival))).first()


def _name(arrival: Arrival) -> str:
    return arrival.recruiter_participant or arrival.visit or ""
