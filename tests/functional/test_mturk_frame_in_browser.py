"""A study within a page of Mechanical Turk's, from accepting to handing in, without a cookie."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from flask import Flask
from playwright.sync_api import Browser, expect

from studyapp.web.running import running
from tests.functional.browsing import IN_A_BROWSER
from tests.functional.every_page import shown
from tests.functional.looking import LAPTOP
from tests.functional.mturk_frame import (
    TASK,
    WORKER,
    frame_of,
    handed_in_from,
    launched_for_frames,
)
from tests.functional.redefining import redefine
from tests.studyapp.taking_part_steps import Participant, SetClock

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with launched_for_frames() as chromium:
        yield chromium


@pytest.fixture
def shown_study(tiny_study: Path) -> Iterator[tuple[str, Flask]]:
    redefine(tiny_study, added='\n[recruitment]\nchannel = "mturk"\n')
    with shown(tiny_study) as study:
        yield study


def test_a_worker_takes_part_in_a_frame_and_hands_the_assignment_in(
    browser: Browser, shown_study: tuple[str, Flask]
) -> None:
    address, app = shown_study
    context = browser.new_context(viewport=LAPTOP)
    page = frame_of(context, WORKER, f"{address}/")
    handed_in = handed_in_from(page)
    page.goto(TASK)
    frame = page.frame_locator("iframe")
    frame.locator("#start button.primary").click()
    expect(frame.locator("[action$='/begin']")).to_be_visible()

    token = page.frames[1].url.partition("/take/")[2]
    with app.app_context():
        here = running()
    Participant(here.database, here.served, SetClock(), token).begin().take_all()
    page.frames[1].goto(f"{address}/take/{token}")
    code = frame.locator("#completion-code").inner_text()
    frame.locator("#leave button").click()

    expect(frame.get_by_text("Thank you", exact=True)).to_be_visible()
    assert handed_in == [{"assignmentId": ["a1"], "completionCode": [code]}]
    assert context.cookies() == []
    context.close()


def test_no_other_site_can_show_it_in_a_frame(
    browser: Browser, shown_study: tuple[str, Flask]
) -> None:
    address, _app = shown_study
    context = browser.new_context()
    page = frame_of(context, "https://evil.example", f"{address}/")
    with page.expect_console_message(lambda message: "frame-ancestors" in message.text):
        page.goto("https://evil.example/")
    assert page.frame_locator("iframe").locator("#start").count() == 0
    context.close()
