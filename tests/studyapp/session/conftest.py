"""What the tests of study sessions share."""

from collections.abc import Callable
from pathlib import Path

import pytest
from sqlalchemy import func, select

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import Place
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from tests.support.studies.redefining import redefine
from tests.support.studies.stored import found_in
from tests.support.studies.taking_part_steps import Participant, SetClock

Open = Callable[..., Participant]


def held_places(database: Database) -> int:
    return found_in(database, select(func.count(Place.study_session_id)))[0]


@pytest.fixture
def open_changed(tiny_study: Path, database: Database, clock: SetClock) -> Open:
    """Return a function that opens the tiny study, changed as `redefine` does.

    It returns a participant who has not arrived yet.
    """

    def make(*changes: tuple[str, str], added: str = "") -> Participant:
        redefine(tiny_study, *changes, added=added)
        served = ServedStudy.read(tiny_study)
        open_study(database, served, clock)
        return Participant(database, served, clock)

    return make
