"""By which pseudonyms exports call the participants of study sessions."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import NamedTuple

from sqlalchemy import ColumnElement, or_, select, true
from sqlalchemy.orm import Session

from studyapp.database.engine import Database
from studyapp.database.tables import StudySession
from studyapp.researchers.pseudonyms import FOLDER, PseudonymKey


class _Identity(NamedTuple):
    """What tells the participant of a study session apart."""

    id: int
    token: str
    visit: str | None
    recruiter_participant: str | None


def pseudonyms_of(
    database: Database, key: PseudonymKey, numbers: Collection[int]
) -> Mapping[int, str]:
    """Return the pseudonym of each of the study sessions `numbers`, as exports have it."""
    chosen = StudySession.id.in_(numbers)
    # Who came twice is called x2 the second time: their other study sessions count too.
    names = select(StudySession.recruiter_participant).where(
        chosen, StudySession.recruiter_participant.is_not(None)
    )
    together = or_(chosen, StudySession.recruiter_participant.in_(names))
    with database.reading() as session:
        named = key.pseudonyms(_identities(session, together))
    return {number: named[number] for number in numbers if number in named}


def number_called(session: Session, key: PseudonymKey | None, name: str) -> int | None:
    """Return the study session that is called `name`; None where there is none.

    Parameters
    ----------
    key : PseudonymKey or None
        By which pseudonyms are found; None where nobody may look for them, or there are none.
    name : str
        Its number, or the participant's pseudonym as an export or a folder of it has it.
    """
    name = name.strip().removeprefix(FOLDER).lower()
    if name.isascii() and name.isdecimal():
        return _numbered(session, name)
    named = {} if key is None else key.pseudonyms(_identities(session, true()))
    return next((number for number, found in named.items() if found == name), None)


def _identities(session: Session, chosen: ColumnElement[bool]) -> list[_Identity]:
    rows = session.execute(
        select(
            StudySession.id,
            StudySession.token,
            StudySession.visit,
            StudySession.recruiter_participant,
        ).where(chosen)
    )
    return [_Identity(*row) for row in rows]


def _numbered(session: Session, digits: str) -> int | None:
    """Return the number if there is such a study session; no database has one of many digits."""
    if len(digits) >= len(str(2**31)):
        return None
    return session.scalars(select(StudySession.id).where(StudySession.id == int(digits))).first()
