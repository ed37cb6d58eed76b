"""Everything around a study's trials in a real browser, and one participant in two windows."""

from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, Route, expect

from studyapp.database.engine import Database
from tests.functional.browsing import IMPATIENT, IN_A_BROWSER, PATIENCE_MS, press
from tests.functional.shown_studies import write_way
from tests.functional.taking_part import (
    WATCHED,
    answers_of,
    expect_trial,
    fill,
    playing_on,
    study_session_of,
    take_trial,
)

pytestmark = IN_A_BROWSER

HEARD_TO_THE_END = """async audio => {
  await audio.play();
  audio.currentTime = audio.duration - 0.5;
}"""


@pytest.fixture(scope="module")
def study(tiny_study_template: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a study with everything around its trials, and a break after two of its four."""
    folder = tmp_path_factory.mktemp("way") / "study"
    write_way(folder, tiny_study_template, trials=3, page="break_every = 2\n")
    return folder


def expect_heading(page: Page, words: str) -> None:
    expect(page.get_by_role("heading", level=1)).to_have_text(words)


def enter(page: Page, address: str, database: Database) -> None:
    """Consent, and enter the digits of the sound check."""
    page.goto(address)
    fill(page, database)
    press(page, "Next")
    fill(page, database)
    press(page, "I agree – start")
    expect_heading(page, "Can you hear this?")
    page.locator("audio").evaluate(HEARD_TO_THE_END)
    expect(page.locator("audio")).to_have_js_property("ended", True)
    fill(page, database)
    page.keyboard.press("Enter")
    expect_heading(page, "A few questions about you")
    fill(page, database)
    press(page, "Next")
    press(page, "Begin with the first pair")


def take_trial_by_keyboard(page: Page) -> None:
    page.keyboard.press("Tab")
    expect(page.locator("#play")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.locator("#watched")).to_have_text(WATCHED)
    for key in ("Tab", "Tab", "Tab", "Space", "ArrowRight", "Tab", "Space", "Enter"):
        page.keyboard.press(key)


def test_a_participant_goes_from_eligibility_to_the_code(
    page: Page, address: str, database: Database
) -> None:
    enter(page, f"{address}/?PROLIFIC_PID=p1&STUDY_ID=s1&SESSION_ID=x1", database)
    take_trial_by_keyboard(page)
    take_trial(page, 2)
    expect_heading(page, "Time for a break")
    page.reload()
    page.go_back()
    expect_heading(page, "Time for a break")
    press(page, "Go on")
    for number in (3, 4):
        take_trial(page, number)
    expect_heading(page, "A few last questions")
    page.get_by_label("Is there anything").fill("Good videos.")
    press(page, "Next")

    page.get_by_role("button", name="Copy the code").click()
    expect(page.locator("#copied")).not_to_be_empty()
    code = page.locator("#completion-code").inner_text()
    done = study_session_of(page, database)
    assert (done.completion_code, done.recruiter_participant) == (code, "p1")
    assert (done.sound_tries, done.rested_at_position) == (0, 3)
    assert [value for *_, value in answers_of(page, database)] == [-2, -1, *[-1] * 6]


def test_the_older_of_two_windows_stops(page: Page, address: str, database: Database) -> None:
    enter(page, address, database)
    with playing_on(page.locator("video")):
        page.get_by_role("button", name="Play both").click()
        second = page.context.new_page()
        second.goto(page.url)

        dialog = page.get_by_role("dialog")
        expect(dialog).to_contain_text("open in another window")
        assert page.locator("video").evaluate("video => video.paused")
    page.bring_to_front()
    for key in ("Escape", "Escape", "1"):
        page.keyboard.press(key)
    expect(dialog).to_be_visible()
    expect(page.locator(":checked")).to_have_count(0)
    expect(second.get_by_role("dialog")).to_have_count(0)

    page.get_by_role("button", name="Go on here").click()
    expect(second.get_by_role("dialog")).to_be_visible()
    take_trial(page, 1)
    expect_trial(page, 2)


def test_neither_a_proxys_page_nor_a_dead_connection_loses_anything(
    browser: Browser, address: str, database: Database
) -> None:
    page = browser.new_page()  # the browser itself complains of status 408
    page.set_default_timeout(PATIENCE_MS)
    page.add_init_script(IMPATIENT)
    enter(page, address, database)
    opened = page.evaluate("performance.timeOrigin")
    unanswered: list[Route] = []
    page.route("**/watched/*", lambda route: route.fulfill(status=408, body="Late"), times=1)
    page.route("**/answers", lambda route: unanswered.append(route), times=1)

    take_trial(page, 1)
    expect(page.locator("#problem")).to_contain_text("The connection is lost")
    assert page.evaluate("performance.timeOrigin") == opened
    expect_trial(page, 2)
    assert len(unanswered) == 1
    assert len(answers_of(page, database)) == 2
    page.close()
