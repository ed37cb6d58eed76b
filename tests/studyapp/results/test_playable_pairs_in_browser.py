from __future__ import annotations

from playwright.sync_api import expect

from studyapp.results.report import report
from tests.functional.browsing import IN_A_BROWSER, SOFTWARE_GRAPHICS, launched
from tests.studyapp.results.conftest import Answered, with_motion

pytestmark = IN_A_BROWSER


def test_a_pair_plays_in_the_report_without_any_other_file(answered: Answered) -> None:
    path = report(
        with_motion(answered("pairwise", people=3), "ours", "theirs", "real"), with_motion=True
    )
    asked: list[str] = []
    complaints: list[str] = []
    with launched(*SOFTWARE_GRAPHICS) as chromium:
        page = chromium.new_page()
        page.on("request", lambda request: asked.append(request.url))
        page.on(
            "console",
            lambda message: complaints.append(message.text) if message.type == "error" else None,
        )
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(path.as_uri())
        pair = page.locator(".playable").first
        pair.get_by_role("button").first.click()
        expect(pair.get_by_role("slider", name="Time")).to_be_visible()
        expect(pair.locator("canvas")).to_be_visible()
    assert asked == [path.as_uri()]
    assert complaints == []
