"""What the tests of researchers' pages share."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from flask import Flask

from studyapp.database.engine import Database
from studyapp.web.running import running
from tests.studyapp.researchers_at_hand import joined
from tests.studyapp.taking_part_steps import SetClock
from tests.studyapp.web.research.research_browser import ResearchBrowser

NAMES = {"owner": "Ada", "analyst": "Charles", "viewer": "Mary"}

LogIn = Callable[[str], ResearchBrowser]


@pytest.fixture(autouse=True)
def hashing_costs_little(cheap_passwords: None) -> None:
    """Spare these tests the cost of real hashes."""


@pytest.fixture
def stored(app: Flask) -> Database:
    """Return the database that the pages show."""
    with app.app_context():
        return running().database


@pytest.fixture
def browser(app: Flask) -> ResearchBrowser:
    """Return a browser in which nobody is logged in."""
    return ResearchBrowser(app)


@pytest.fixture
def log_in(app: Flask, stored: Database, clock: SetClock) -> LogIn:
    """Return a function that logs somebody of a role in, in a browser of their own."""
    for role, name in NAMES.items():
        joined(stored, clock, name, role)  # type: ignore[arg-type]

    def browser_of(role: str) -> ResearchBrowser:
        opened = ResearchBrowser(app)
        assert opened.log_in(NAMES[role]).status_code == 303
        return opened

    return browser_of
