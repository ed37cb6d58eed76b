"""A whole study session below a path, in another site's frame, with no storage."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from tests.functional.browsing import IN_A_BROWSER, PATIENCE_MS, serving
from tests.functional.every_page import shown
from tests.functional.looking import LAPTOP, photograph
from tests.functional.mturk_frame import (
    TASK,
    WORKER,
    frame_of,
    handed_in_from,
    launched_for_frames,
)
from tests.support.studies.redefining import redefine

pytestmark = IN_A_BROWSER

PREFIX = "/studies/one"

NO_STORAGE = """
if (window !== window.top) {
  for (const [owner, name] of [[window, "sessionStorage"], [window, "localStorage"],
                               [document, "cookie"]]) {
    Object.defineProperty(owner, name, {
      get() { throw new DOMException("denied", "SecurityError"); },
      set() { throw new DOMException("denied", "SecurityError"); },
    });
  }
}
"""
"""What a browser does in frames of others that may keep nothing."""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with launched_for_frames() as chromium:
        yield chromium


@pytest.fixture
def study(tiny_study: Path) -> Path:
    """Return a study of two trials."""
    redefine(
        tiny_study,
        ("trials = 4\npractice = 1", "trials = 1\npractice = 0"),
        added='\n[recruitment]\nchannel = "mturk"\n',
    )
    return tiny_study


def test_a_worker_takes_the_whole_study_in_a_frame_below_a_path(
    browser: Browser, study: Path
) -> None:
    complaints: list[str] = []
    asked: list[str] = []

    context = browser.new_context(viewport=LAPTOP)
    context.set_default_timeout(PATIENCE_MS)
    context.add_init_script(NO_STORAGE)
    with serving(study, "--prefix", PREFIX) as address:
        # Without the slash at its end, as people write an address.
        page = frame_of(context, WORKER, f"{address}{PREFIX}")
        handed_in = handed_in_from(page)
        page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        page.goto(TASK)
        frame = page.frame_locator("iframe")
        frame.get_by_role("button", name="I agree").click()
        frame.get_by_role("button", name="Begin").click()
        for number in (1, 2):
            expect(frame.locator(".progress")).to_contain_text(f"Trial {number} of 2")
            frame.get_by_role("button", name="Play both").click()
            expect(frame.locator("#watched")).to_have_text("Watched ✓")
            if number == 2:
                photograph(page, "trial-in-a-frame", resized=False)
            for question in frame.locator("#answers .question").all():
                question.locator(".scale label").nth(1).click()
            frame.get_by_role("button", name="Next").click()
        expect(frame.locator("#completion-code")).to_be_visible()
        code = frame.locator("#completion-code").inner_text()
        frame.locator("#leave button").click()
        expect(frame.get_by_text("Thank you", exact=True)).to_be_visible()

    assert handed_in == [{"assignmentId": ["a1"], "completionCode": [code]}]
    assert context.cookies() == []
    assert complaints == []
    own = [url for url in asked if "mturk.com" not in url]
    assert [url for url in own if not url.startswith(f"{address}{PREFIX}")] == []
    assert {"media", "static", "take"} <= {url.split(f"{PREFIX}/")[-1].split("/")[0] for url in own}
    context.close()


def test_no_other_site_can_show_it_in_a_frame(browser: Browser, study: Path) -> None:
    context = browser.new_context()
    with shown(study) as (address, _app):
        page = frame_of(context, "https://evil.example", f"{address}/")
        with page.expect_console_message(lambda message: "frame-ancestors" in message.text):
            page.goto("https://evil.example/")
        assert page.frame_locator("iframe").locator("#start").count() == 0
        context.close()
