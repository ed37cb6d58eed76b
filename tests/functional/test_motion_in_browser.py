"""Turning motion around on researchers' pages in a real browser, which keep their strict policy.

With ``SCREENSHOTS=folder`` in the environment each page is also taken in every size.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from studyapp.study.folder import StudyFolder
from tests.functional.browsing import (
    IN_A_BROWSER,
    SOFTWARE_GRAPHICS,
    commanded,
    follow,
    launched,
    press,
    wait_until,
    watched_page,
)
from tests.functional.conftest import SECONDS
from tests.functional.joining import join
from tests.functional.looking import LAPTOP, SIZES, examination, photograph, resize
from tests.support.studies.takes import write_motion

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with launched(*SOFTWARE_GRAPHICS) as chromium:
        yield chromium


def expect_motion(page: Page, *names: str) -> None:
    """Wait until the viewer shows motion by these names, and plays it to the end."""
    expect(page.locator(".motion-viewer .labels b")).to_have_text(names)
    viewer = page.locator(".motion-viewer")
    viewer.get_by_role("button", name="Play").click()
    wait_until(page, lambda: float(viewer.get_attribute("data-seconds") or "0") >= SECONDS - 0.1)


def test_motion_turns_around_at_the_desk_and_in_a_preview(browser: Browser, lab: Path) -> None:
    folder = StudyFolder(lab / "tiny")
    for condition in ("rule_based", "mismatched", "broken"):
        for number in range(4):
            write_motion(folder.clip(condition, f"take-{number}"), SECONDS)
    with (
        examination("motion") as examine,
        commanded("desk", lab) as (address, link),
        watched_page(browser, address) as page,
    ):
        join(page, link)
        press(page, "Take over tiny")
        follow(page.get_by_role("link", name="All segments and conditions"))
        examine(page, "table")
        follow(page.get_by_role("link", name="motion of broken for take-0"))
        page.get_by_role("button", name="Turn the motion around").click()
        expect_motion(page, "broken")
        examine(page, "clip")
        follow(page.get_by_role("link", name="All conditions side by side"))
        page.get_by_role("button", name="Play rule based, mismatched, broken").click()
        expect_motion(page, "rule based", "mismatched", "broken")
        examine(page, "segment")
        resize(page, SIZES["phone"])
        page.reload()
        page.get_by_role("button", name="Play rule based, mismatched, broken").click()
        expect(page.locator(".motion-viewer")).to_have_attribute("data-rows", "2")
        photograph(page, "motion-segment-narrow", resized=False)
        resize(page, LAPTOP)
        page.goto(f"{address}/research/studies/tiny/")
        press(page, "Watch")
        page.goto(f"{address}/tiny/research/preview/0/1/1/")
        follow(page.get_by_role("link", name="Turn the motion around"))
        page.get_by_role("button", name="Play A").click()
        expect(page.locator(".motion-viewer canvas")).to_be_visible()
        examine(page, "preview")
