"""What the tests of the study app share."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from flask import Flask

from studyapp.services.database import Database, sqlite_url
from studyapp.services.served_study import ServedStudy
from studyapp.services.versions import open_study
from studyapp.web.app import create_app
from studyapp.web.running import attach, running
from tests.studyapp.taking_part_steps import Participant, SetClock


@pytest.fixture
def clock() -> SetClock:
    return SetClock()


@pytest.fixture
def served(tiny_study: Path) -> ServedStudy:
    return ServedStudy.read(tiny_study)


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    opened = Database.open(sqlite_url(tmp_path / "responses.db"))
    yield opened
    opened.close()


@pytest.fixture
def opened(database: Database, served: ServedStudy, clock: SetClock) -> Database:
    """Return a database that knows the study and its places."""
    open_study(database, served, clock)
    return database


@pytest.fixture
def app(tiny_study: Path, clock: SetClock) -> Iterator[Flask]:
    """Return the application of `tiny_study` on a clock that the test moves."""
    made = create_app(tiny_study)
    with made.app_context():
        here = running()
    attach(made, replace(here, clock=clock))
    yield made
    here.database.close()


@pytest.fixture
def participant(opened: Database, served: ServedStudy, clock: SetClock) -> Participant:
    """Return a participant at the first trial."""
    return Participant(opened, served, clock).enrol().begin()
