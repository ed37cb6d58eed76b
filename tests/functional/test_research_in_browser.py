"""A researcher's way in a real browser: join, watch, invite, log out.

With ``SCREENSHOTS=folder`` in the environment each page is also taken in every size.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from studyapp.clock import Clock
from studyapp.database.engine import Database, sqlite_url
from studyapp.session.arrivals import Arrival
from studyapp.session.comprehension import start_trials
from studyapp.session.enrolment import enrol
from studyapp.session.participation import load_situation
from studyapp.session.served_study import ServedStudy
from tests.functional.browsing import IN_A_BROWSER, follow, watched_page
from tests.functional.every_page import shown
from tests.functional.joining import join, link_for_owner
from tests.functional.looking import examination, photograph

pytestmark = IN_A_BROWSER


@pytest.fixture
def served_at(tiny_study: Path) -> Iterator[str]:
    with shown(tiny_study) as (address, _):
        yield address


@pytest.fixture
def stored(tiny_study: Path, served_at: str) -> Iterator[Database]:
    database = Database.open(sqlite_url(tiny_study / "responses.db"))
    with closing(database):
        yield database


def come(database: Database, study: Path, name: str) -> None:
    """Let a participant come as far as the first trial."""
    served, clock = ServedStudy.read(study), Clock()
    token = enrol(database, served, Arrival(visit=name), clock)
    start_trials(database, served, token, clock)
    load_situation(database, served, token, clock)


def join_as_owner(page: Page, address: str, database: Database) -> None:
    join(page, link_for_owner(address, database))
    expect(page.locator(".truth")).to_contain_text("of 4 places done")


def test_no_page_of_researchers_has_a_severe_barrier(
    browser: Browser, served_at: str, stored: Database, tiny_study: Path
) -> None:
    come(stored, tiny_study, "one")
    with examination("research") as examine, watched_page(browser, served_at) as page:
        page.goto(f"{served_at}/research/")
        expect(page.get_by_role("heading", level=1)).to_have_text("Log in as a researcher")
        examine(page, "log-in")
        page.goto(link_for_owner(served_at, stored))
        examine(page, "join")
        join_as_owner(page, served_at, stored)
        examine(page, "overview")
        follow(page.get_by_role("link", name="1 active", exact=True))
        examine(page, "study-sessions")
        follow(page.get_by_role("link", name="1", exact=True))
        expect(page.locator(".events")).to_contain_text("Trial 1 was shown")
        examine(page, "study-session")
        follow(page.get_by_role("link", name="Researchers"))
        page.get_by_label("viewer").check()
        follow(page.get_by_role("button", name="Make a link", exact=True))
        expect(page.locator("output.link")).to_contain_text("/research/join/")
        examine(page, "researchers")
        follow(page.get_by_role("link", name="Preview"))
        examine(page, "preview")
        follow(page.get_by_role("link", name="1", exact=True))
        expect(page.locator("header")).to_contain_text("Preview: nothing is stored")
        photograph(page, "research-previewed-trial")
        page.locator("#play").click()
        for question in page.locator("#answers .question").all():
            question.locator(".scale label").nth(1).click()
        page.get_by_role("button", name="Next").click()
        expect(page.locator(".progress")).to_contain_text("Trial 2 of 6")
        follow(page.get_by_role("link", name="All trials of this place"))
        follow(page.get_by_role("link", name="Recruitment"))
        page.get_by_label("Reason, for the log").first.fill("a video stalls")
        follow(page.get_by_role("button", name="Pause"))
        expect(page.locator(".truth")).to_contain_text("No new participants are admitted")
        examine(page, "newcomers")
        follow(page.get_by_role("link", name="Changes"))
        examine(page, "changes")
        follow(page.get_by_role("link", name="Ada Lovelace"))
        examine(page, "own-account")
        follow(page.get_by_role("button", name="Log out"))
        expect(page.get_by_role("heading", level=1)).to_have_text("Log in as a researcher")
        assert page.goto(f"{served_at}/research/changes") is not None
        assert "/research/log-in?next=/research/changes" in page.url


def test_the_overview_shows_who_comes_while_one_looks(
    browser: Browser, served_at: str, stored: Database, tiny_study: Path
) -> None:
    with watched_page(browser, served_at) as page:
        page.clock.install()
        join_as_owner(page, served_at, stored)
        expect(page.locator(".truth")).to_contain_text("0 active")

        come(stored, tiny_study, "one")
        page.clock.fast_forward(21_000)

        expect(page.locator(".truth")).to_contain_text("1 active")
        stays = page.locator("#live time").last
        expect(stays).not_to_contain_text("UTC")
        follow(page.get_by_role("link", name="Keep it still"))
        expect(page.locator("footer")).to_contain_text("stays as it is")


def test_without_scripts_the_overview_is_the_same_and_asks_for_itself(
    browser: Browser, served_at: str, stored: Database
) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()

    join_as_owner(page, served_at, stored)

    expect(page.locator("#live time").last).to_contain_text("UTC")
    expect(page.locator("meta[http-equiv=refresh]")).to_have_count(1)
    context.close()
