"""A whole study session below a path, behind a proxy, in another site's frame, with no storage."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import parse_qs

import pytest
from playwright.sync_api import Browser, Route, expect, sync_playwright

from tests.functional.browsing import (
    ARGUMENTS,
    CHROMIUM,
    IN_A_BROWSER,
    LAPTOP,
    screenshots_folder,
    serving,
)
from tests.functional.passing_on import passing_on

pytestmark = IN_A_BROWSER

PREFIX = "/studies/one"
NAMES = "workerId=w1&hitId=h1&assignmentId=a1&turkSubmitTo=https%3A%2F%2Fwww.mturk.com"

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


@pytest.fixture
def browser() -> Iterator[Browser]:
    """Give a browser in which public sites may show what this machine serves."""
    arguments = (*ARGUMENTS, "--disable-features=LocalNetworkAccessChecks")
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield chromium
        chromium.close()


@pytest.fixture
def study(tiny_study_template: Path, tmp_path: Path) -> Path:
    folder = tmp_path / "study"
    shutil.copytree(tiny_study_template, folder)
    definition = folder / "study.toml"
    text = definition.read_text("utf-8")
    definition.write_text(text + '\n[recruitment]\nchannel = "mturk"\n', "utf-8")
    return folder


def test_a_worker_takes_the_whole_study_in_a_frame_below_a_path(
    browser: Browser, study: Path, tmp_path: Path
) -> None:
    handed_in: list[dict[str, list[str]]] = []
    complaints: list[str] = []
    asked: list[str] = []

    def take(route: Route) -> None:
        handed_in.append(parse_qs(route.request.post_data or ""))
        route.fulfill(body="Thank you", content_type="text/plain")

    context = browser.new_context(viewport=LAPTOP)
    context.add_init_script(NO_STORAGE)
    with (
        serving(study, prefix=PREFIX) as server,
        passing_on(server, PREFIX) as (proxy, beside),
    ):
        # Without the slash at its end, as people write an address.
        framing = f'<iframe src="{proxy}{PREFIX}?{NAMES}" width="1300" height="740"></iframe>'
        context.route(
            "https://worker.mturk.com/**",
            lambda route: route.fulfill(body=framing, content_type="text/html"),
        )
        page = context.new_page()
        page.route("https://www.mturk.com/mturk/externalSubmit", take)
        page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        page.goto("https://worker.mturk.com/projects/1/tasks/1")
        frame = page.frame_locator("iframe")
        frame.get_by_role("button", name="I agree").click()
        frame.get_by_role("button", name="Begin").click()
        for number in range(1, 7):
            expect(frame.locator(".progress")).to_contain_text(
                f"Trial {number} of 6", timeout=20_000
            )
            frame.get_by_role("button", name="Play both").click()
            expect(frame.locator("#watched")).to_have_text("Watched ✓", timeout=15_000)
            if number == 2:
                page.screenshot(path=screenshots_folder(tmp_path) / "trial-in-a-frame.png")
            for question in frame.locator("#answers .question").all():
                question.locator(".scale label").nth(1).click()
            frame.get_by_role("button", name="Next").click()
        expect(frame.locator("#completion-code")).to_be_visible(timeout=20_000)
        code = frame.locator("#completion-code").inner_text()
        frame.locator("#leave button").click()
        expect(frame.get_by_text("Thank you", exact=True)).to_be_visible()

    assert handed_in == [{"assignmentId": ["a1"], "completionCode": [code]}]
    assert context.cookies() == []
    assert complaints == []
    assert beside == []
    here = [url for url in asked if "mturk.com" not in url]
    assert [url for url in here if not url.startswith(f"{proxy}{PREFIX}")] == []
    assert {"media", "static", "take"} <= {
        url.split(f"{PREFIX}/")[-1].split("/")[0] for url in here
    }
    context.close()
