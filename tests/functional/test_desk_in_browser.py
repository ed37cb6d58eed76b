"""A desk in a real browser: from the first login to a study that is changed and tried.

With ``SCREENSHOTS=folder`` in the environment each page is also taken in every size.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Browser, Page, expect

from tests.functional.browsing import IN_A_BROWSER, commanded, follow, press, watched_page
from tests.functional.joining import NAME, join
from tests.functional.looking import barriers, expect_to_fit_a_phone, photograph

pytestmark = IN_A_BROWSER


def test_a_researcher_makes_a_study_changes_one_and_tries_it(browser: Browser, lab: Path) -> None:
    found: dict[str, list[str]] = {}
    with (
        commanded("desk", lab) as (address, link),
        watched_page(browser, address, refused=422) as page,
    ):

        def look_at(name: str) -> None:
            photograph(page, f"desk-{name}")
            found[name] = barriers(page)
            expect_to_fit_a_phone(page)

        join(page, link)
        expect(page).to_have_title("Studies – Desk of lab")
        look_at("first")
        _make(page, look_at)
        _change(page, address, look_at)
        _try_and_watch(page, look_at)
        follow(page.get_by_role("link", name="Back to the desk"))
        press(page, "Log out")
        page.goto(f"{address}/tiny/research/")
        expect(page.get_by_label("Password")).to_be_visible()
    assert {name: problems for name, problems in found.items() if problems} == {}


def _make(page: Page, look_at: Callable[[str], None]) -> None:
    follow(page.get_by_role("link", name="Make a study"))
    look_at("choose-template")
    page.get_by_role("radio", name="rating").check()
    press(page, "Next")
    look_at("describe-study")
    page.get_by_label("Name", exact=True).fill("first-try")
    page.get_by_label("Naturalness").fill("How natural is it?")
    page.get_by_label("Contact").fill("me")
    press(page, "Make the study")
    expect(page.get_by_role("alert")).to_contain_text("how to reach anybody")
    page.get_by_label("Contact").fill("me@example.org")
    press(page, "Make the study")
    expect(page.get_by_role("heading", level=1)).to_have_text("Motion study")
    expect(page.get_by_text("is being made")).to_be_visible()
    look_at("being-made")
    follow(page.get_by_role("link", name="Settings"))
    expect(page.get_by_role("textbox")).to_have_value(re.compile(r"How natural is it\?"))


def _change(page: Page, address: str, look_at: Callable[[str], None]) -> None:
    page.goto(f"{address}/research/")
    press(page, "Take over tiny")
    expect(page.get_by_text("ready for participants")).to_be_visible()
    expect(page.get_by_role("status")).to_have_text(f"{address}/tiny/")
    look_at("study")
    follow(page.get_by_role("link", name="Settings"))
    text = page.get_by_role("textbox")
    good = text.input_value()
    text.fill(good.replace("trials = 4", "trails = 4"))
    press(page, "Save")
    expect(page.get_by_role("alert")).to_contain_text("did you mean 'trials'?")
    look_at("settings-wrong")
    selected = "area => area.value.slice(area.selectionStart, area.selectionEnd)"
    page.get_by_role("link", name="line 5").click()
    assert text.evaluate(selected) == "trails = 4"
    text.fill(good.replace("Gestures and speech", "Gestures once more"))
    press(page, "Save")
    expect(page.get_by_text("Saved.")).to_be_visible()
    look_at("settings")
    follow(page.get_by_role("link", name="Back to tiny"))
    expect(page.get_by_role("heading", level=1)).to_have_text("Gestures once more")


def _try_and_watch(page: Page, look_at: Callable[[str], None]) -> None:
    study = page.url
    press(page, "Take part as a test")
    expect(page.get_by_text("This is a test participation")).to_be_visible()
    page.goto(study)
    press(page, "Watch")
    expect(page.get_by_role("heading", level=1)).to_have_text("How the study goes")
    expect(page.get_by_role("navigation")).to_contain_text(NAME)
    look_at("watch")
