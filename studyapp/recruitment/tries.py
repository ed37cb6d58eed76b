"""Test participations: the whole study on a database of its own, so that nothing of it counts."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

from sqlalchemy import delete, func, select

from studyapp.clock import Clock
from studyapp.database.engine import Database, sqlite_url
from studyapp.database.scrubbing import leave_nothing
from studyapp.database.tables import Base, StudySession
from studyapp.recruitment.invitations import make_invitations
from studyapp.session.arrival.intake import present_intake
from studyapp.session.arrival.intake_decisions import extend
from studyapp.session.arrival.places import has_open_place
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from studyapp.study.folder import StudyFolder


def make_test_participation(root: Path, served: ServedStudy, clock: Clock, *, by: str) -> str:
    """Return the token of a link by which somebody can try the study in folder `root` once.

    There is always a place for it: where all were tried, one more opens in each arm.

    Parameters
    ----------
    by : str
        Who asks for it.
    """
    tried = served.opened_to_try()
    with closing(Database.open(sqlite_url(StudyFolder(root).tries))) as database:
        open_study(database, tried, clock, new_version=True)
        with database.reading() as session:
            is_full = not has_open_place(session, tried, present_intake(session), clock.now())
        if is_full:
            extend(database, tried, clock, 1, by=by, reason="every place has been tried")
        (token,) = make_invitations(database, 1, clock)
    return token


def count_test_participations(root: Path) -> int:
    """Return how many people have begun to try the study in folder `root`."""
    file = StudyFolder(root).tries
    if not file.exists():
        return 0
    with closing(Database.open(sqlite_url(file))) as database:
        return _count(database)


def erase_test_participations(root: Path) -> int:
    """Erase all test participations of the study in folder `root`; return how many there were."""
    file = StudyFolder(root).tries
    if not file.exists():
        return 0
    with closing(Database.open(sqlite_url(file))) as database:
        count = _count(database)
        with database.writing() as session:
            for table in reversed(Base.metadata.sorted_tables):
                session.execute(delete(table))
        leave_nothing(database)
    return count


def _count(database: Database) -> int:
    with database.reading() as session:
        return session.scalar(select(func.count(StudySession.id))) or 0
