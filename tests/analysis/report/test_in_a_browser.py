from __future__ import annotations

from pathlib import Path

import pytest

from analysis.report import KnownShare, write_report

CHROMIUM = Path("/usr/bin/chromium")

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def browser():
    """Return Debian's Chromium, or skip the tests."""
    if not CHROMIUM.exists():
        pytest.skip("Chromium is not installed: apt-get install chromium")
    sync_api = pytest.importorskip("playwright.sync_api")
    with sync_api.sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path=str(CHROMIUM), args=["--no-sandbox", "--disable-gpu"]
        )
        yield chromium
        chromium.close()


@pytest.fixture
def rehearsal_report(simulated_study, tmp_path):
    study = simulated_study(participants=5, segments=8)
    truth = {("rule_based_vs_static", "emotion"): KnownShare(share=0.8, on_these_segments=0.8)}
    return write_report(study.inputs(origin="rehearsal", truth=truth), tmp_path)


@pytest.mark.parametrize("width", [1280, 420])
def test_the_page_asks_for_nothing_complains_of_nothing_and_fits(browser, rehearsal_report, width):
    page = browser.new_page(viewport={"width": width, "height": 800})
    asked, complaints = [], []
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(rehearsal_report.as_uri())
    assert asked == [rehearsal_report.as_uri()]
    assert complaints == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    page.close()


def test_a_rehearsal_is_called_one_on_every_screen(browser, rehearsal_report):
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.goto(rehearsal_report.as_uri())
    height = page.evaluate("document.documentElement.scrollHeight")
    assert height > 2000
    for top in range(0, height, 700):
        page.evaluate(f"window.scrollTo(0, {top})")
        box = page.locator(".banner").bounding_box()
        assert box["y"] == pytest.approx(0, abs=1)
        assert box["height"] > 20
    page.close()


def test_the_first_screen_holds_answer_figure_and_flow(browser, rehearsal_report):
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.goto(rehearsal_report.as_uri())
    for part in ("h1", ".answer", "figure svg", ".flow"):
        box = page.locator(part).first.bounding_box()
        assert box["y"] + box["height"] <= 800, part
    page.close()
