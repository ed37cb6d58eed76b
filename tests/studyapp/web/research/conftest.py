"""What the tests of researchers' pages share."""

from dataclasses import dataclass

import pytest
from flask import Flask

from studyapp.database.engine import Database
from studyapp.web.site import site_of
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.support.researcher_accounts import joined
from tests.support.studies.taking_part_steps import Participant, SetClock

NAMES = {"owner": "Ada", "analyst": "Charles", "viewer": "Mary"}


@dataclass(frozen=True)
class LogIn:
    """Logs somebody with a role in to a study's pages, in a separate browser."""

    app: Flask
    stored: Database
    clock: SetClock

    def __call__(self, role: str) -> ResearchBrowser:
        opened = ResearchBrowser(self.app)
        assert opened.log_in(NAMES[role]).status_code == 303
        return opened


@pytest.fixture
def stored(app: Flask) -> Database:
    """Return the database that the pages show."""
    return site_of(app).database


@pytest.fixture
def people(app: Flask, clock: SetClock) -> list[Participant]:
    """Return two participants: one has finished, the other is at the second trial."""
    site = site_of(app)
    done = Participant(site.database, site.served, clock).enrol("a").begin()
    done.take_all()
    other = Participant(site.database, site.served, clock).enrol("b").begin()
    other.take_trial()
    other.look()
    return [done, other]


@pytest.fixture
def browser(app: Flask) -> ResearchBrowser:
    """Return a browser in which nobody is logged in."""
    return ResearchBrowser(app)


@pytest.fixture
def log_in(app: Flask, stored: Database, clock: SetClock) -> LogIn:
    """Return what logs in an owner, an analyst or a viewer."""
    for role, name in NAMES.items():
        joined(stored, clock, name, role)  # type: ignore[arg-type]
    return LogIn(app, stored, clock)
