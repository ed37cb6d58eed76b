"""A lab's first study, from login to a rehearsed and served study, in a real browser.

With ``SCREENSHOTS=folder`` in the environment each page is also taken in every size.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from tests.functional.browsing import IN_A_BROWSER, commanded, follow, press, watched_page
from tests.functional.desk_way import STUDY, walk_the_desk, write_recordings
from tests.functional.looking import (
    barriers,
    expect_to_fit_a_phone,
    participants_barriers,
    photograph,
)

pytestmark = IN_A_BROWSER

SECONDS = 1.0


def test_a_first_study_goes_from_login_to_rehearsed_and_served_without_a_shell(
    browser: Browser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DATABASE_URL", raising=False)
    (tmp_path / "lab").mkdir()
    recordings = write_recordings(tmp_path / "recordings", seconds=SECONDS)
    problems: dict[str, list[str]] = {}
    with (
        commanded("desk", tmp_path / "lab") as (address, link),
        watched_page(browser, address, refused=422) as page,
        watched_page(browser, address) as visitor,
    ):
        way = walk_the_desk(page, visitor, link, recordings, participants=2, size=160)
        for stop in way:
            photograph(stop.page, f"desk-{stop.name}")
            if stop.kind == "document":
                continue
            look = barriers if stop.kind == "researchers" else participants_barriers
            problems[stop.name] = look(stop.page)
            expect_to_fit_a_phone(stop.page)
        follow(page.get_by_role("link", name="Back to the desk"))
        press(page, "Log out")
        page.goto(f"{address}/{STUDY}/research/")
        expect(page.get_by_label("Password")).to_be_visible()
    assert {name: each for name, each in problems.items() if each} == {}
