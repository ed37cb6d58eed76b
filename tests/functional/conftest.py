"""Fixtures of browser tests, for modules with a fixture `study`."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

from studyapp.database.engine import Database, sqlite_url
from tests.functional.browsing import launched, serving, watched_page
from tests.support.fast_applications import fast_applications
from tests.support.studies.tiny_study import write_tiny_study

SECONDS = 1.0
"""Length of every video here: they are played in real time."""


@pytest.fixture(scope="session", autouse=True)
def _fast_applications() -> Iterator[None]:
    with fast_applications(), pytest.MonkeyPatch.context() as patch:
        # The answers of these studies are beside them.
        patch.delenv("DATABASE_URL", raising=False)
        yield


@pytest.fixture(scope="session")
def tiny_study_template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the tiny study with shorter videos than other tests have."""
    folder = tmp_path_factory.mktemp("tiny-study")
    write_tiny_study(folder, seconds=SECONDS)
    return folder


@pytest.fixture(scope="module")
def address(study: Path) -> Iterator[str]:
    """Serve the study, and return where."""
    with serving(study) as url:
        yield url


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with launched() as chromium:
        yield chromium


@pytest.fixture
def page(browser: Browser, address: str) -> Iterator[Page]:
    with watched_page(browser, address) as opened:
        yield opened


@pytest.fixture
def database(study: Path) -> Iterator[Database]:
    opened = Database.open(sqlite_url(study / "responses.db"))
    yield opened
    opened.close()
