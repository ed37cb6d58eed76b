"""A whole study session below a path, in another site's frame, with no storage."""

from collections.abc import Iterator
from pathlib import Path
from urllib.parse import parse_qs

import pytest
from playwright.sync_api import Browser, Route, expect

from tests.functional.browsing import IN_A_BROWSER, PATIENCE_MS, launched, serving
from tests.functional.page_checks import LAPTOP
from tests.functional.taking_part import take_trial
from tests.support.studies.redefining import redefine

pytestmark = IN_A_BROWSER

PREFIX = "/studies/one"
WORKER = "https://worker.mturk.com"
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


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    # Public sites may show what this machine serves.
    with launched("--disable-features=LocalNetworkAccessChecks") as chromium:
        yield chromium


def test_a_worker_takes_the_whole_study_in_a_frame_on_a_sub_path(
    browser: Browser, tiny_study: Path
) -> None:
    two_trials = ("trials = 4\npractice = 1", "trials = 1\npractice = 0")
    redefine(tiny_study, two_trials, added='\n[recruitment]\nchannel = "mturk"\n')
    complaints: list[str] = []
    asked: list[str] = []

    context = browser.new_context(viewport=LAPTOP)
    context.set_default_timeout(PATIENCE_MS)
    context.add_init_script(NO_STORAGE)
    with serving(tiny_study, "--address", f"http://127.0.0.1:{{port}}{PREFIX}") as address:
        # Without the slash at its end, as people write an address.
        source = f"{address}{PREFIX}?{NAMES}"
        frame_of = f'<iframe src="{source}" width="1300" height="740"></iframe>'
        context.route(f"{WORKER}/**", lambda r: r.fulfill(body=frame_of, content_type="text/html"))
        page = context.new_page()
        handed_in: list[dict[str, list[str]]] = []

        def take(route: Route) -> None:
            handed_in.append(parse_qs(route.request.post_data or ""))
            route.fulfill(body="Thank you", content_type="text/plain")

        page.route("https://www.mturk.com/mturk/externalSubmit", take)
        page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        page.goto(f"{WORKER}/projects/1/tasks/1")
        _, frame = page.frames
        frame.get_by_role("button", name="I agree").click()
        frame.get_by_role("button", name="Begin").click()
        for number in (1, 2):
            take_trial(frame, number)
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
