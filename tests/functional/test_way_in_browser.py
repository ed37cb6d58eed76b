"""A participant's way around the trials in a real browser."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, ViewportSize, expect
from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables import FormAnswer, Response, Trial, WatchRecord
from tests.functional.browsing import (
    IN_A_BROWSER,
    expect_trial,
    follow,
    playing_on,
    study_session_of,
)
from tests.functional.looking import LAPTOP, photograph
from tests.support.studies.asked_forms import CLOSING, CONSENT, DEMOGRAPHICS, ELIGIBILITY, SCALE
from tests.support.studies.redefining import redefine

pytestmark = IN_A_BROWSER

WAY = ELIGIBILITY + CONSENT + DEMOGRAPHICS + SCALE + CLOSING
HEARD_TO_THE_END = """async audio => {
  await audio.play();
  audio.currentTime = audio.duration - 0.5;
}"""
PHONE: ViewportSize = {"width": 390, "height": 844}


@pytest.fixture(scope="module")
def study(tiny_study_template: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a study with everything around its trials, and a break after two of its four."""
    folder = tmp_path_factory.mktemp("way") / "study"
    shutil.copytree(tiny_study_template, folder)
    redefine(
        folder,
        ("[page]\n", "[page]\nsound_check = true\nbreak_every = 2\n"),
        ("trials = 4\npractice = 1", "trials = 3\npractice = 0"),
        added=WAY,
    )
    return folder


def heading(page: Page, words: str) -> None:
    expect(page.get_by_role("heading", level=1)).to_have_text(words)


def press(page: Page, name: str) -> None:
    page.get_by_role("button", name=name, exact=True).click()


def enter(page: Page, address: str) -> None:
    page.goto(address)
    page.get_by_label("yes").check()
    follow(page.get_by_role("button", name="Next"))
    page.get_by_label("yes").check()
    press(page, "I agree – start")
    heading(page, "Can you hear this?")


def hear(page: Page, database: Database) -> None:
    digits = study_session_of(page, database).sound_digits
    page.get_by_label("The digits you hear").fill(digits)
    page.keyboard.press("Enter")
    heading(page, "A few questions about you")


def begin(page: Page) -> None:
    page.get_by_label("How old are you?").fill("31")
    page.get_by_label("3 – every day").check()
    press(page, "Next")
    press(page, "Begin with the first pair")


def take_trial(page: Page, number: int) -> None:
    expect_trial(page, number)
    press(page, "Play both")
    for question in ("rhythm", "emotion"):
        page.locator(f"[data-question={question}]").get_by_text("slightly A", exact=True).click()
    expect(page.locator("#needed")).to_have_class(re.compile("complete"))
    page.locator("#next").click()


def test_the_whole_way_from_eligibility_to_the_code(
    page: Page, address: str, database: Database
) -> None:
    page.goto(f"{address}/?PROLIFIC_PID=p1&STUDY_ID=s1&SESSION_ID=x1")
    page.get_by_label("yes").check()
    press(page, "Next")
    expect(page.get_by_role("button", name="I agree")).to_be_visible()
    page.get_by_label("yes").check()
    press(page, "I agree – start")

    heading(page, "Can you hear this?")
    page.locator("audio").evaluate(HEARD_TO_THE_END)
    expect(page.locator("audio")).to_have_js_property("ended", True)
    hear(page, database)

    begin(page)
    for number in (1, 2):
        take_trial(page, number)
    heading(page, "Time for a break")
    page.reload()
    page.go_back()
    heading(page, "Time for a break")
    press(page, "Go on")
    for number in (3, 4):
        take_trial(page, number)
    heading(page, "A few last questions")
    page.get_by_label("Is there anything").fill("Good videos.")
    press(page, "Next")

    press(page, "Copy the code")
    expect(page.locator("#copied")).not_to_be_empty()
    code = page.locator("#completion-code").inner_text()
    done = study_session_of(page, database)
    assert (done.completion_code, done.recruiter_participant) == (code, "p1")
    assert (done.sound_tries, done.rested_at_position) == (0, 3)
    values = select(Response.value).join(Response.trial).where(Trial.study_session_id == done.id)
    with database.reading() as session:
        assert session.scalars(values).all() == [-1] * 8


def test_who_cannot_hear_the_sound_is_helped_and_may_leave(browser: Browser, address: str) -> None:
    page = browser.new_page(viewport=LAPTOP)
    enter(page, address)
    for _ in range(3):
        expect(page.get_by_role("button", name="I cannot hear it")).to_have_count(0)
        page.get_by_label("The digits you hear").fill("12345")
        follow(page.get_by_role("button", name="Next"))
        expect(page.get_by_role("alert")).to_contain_text("not the digits that were spoken")
    photograph(page, "way-3-sound-check")

    page.get_by_role("button", name="I cannot hear it").click()

    heading(page, "You have left the study")
    photograph(page, "way-3-left")
    page.close()


def test_of_two_windows_the_older_gives_way(page: Page, address: str, database: Database) -> None:
    enter(page, address)
    hear(page, database)
    begin(page)
    with playing_on(page.locator("video")):
        press(page, "Play both")
        second = page.context.new_page()
        second.goto(page.url)

        dialog = page.get_by_role("dialog")
        expect(dialog).to_contain_text("open in another window")
        assert page.locator("video").evaluate("video => video.paused")
    page.bring_to_front()
    photograph(page, "way-7-another-window")
    for _ in range(2):
        page.keyboard.press("Escape")
    page.keyboard.press("1")
    expect(dialog).to_be_visible()
    expect(page.locator(":checked")).to_have_count(0)
    expect(second.get_by_role("dialog")).to_have_count(0)

    press(page, "Go on here")
    expect(second.get_by_role("dialog")).to_be_visible()
    take_trial(page, 1)
    expect_trial(page, 2)


def test_a_phone_is_asked_to_come_back_on_another_device(browser: Browser, address: str) -> None:
    link = f"{address}/?PROLIFIC_PID=p2"
    context = browser.new_context(
        viewport=PHONE, screen={"width": 390, "height": 844}, has_touch=True, is_mobile=True
    )
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    phone = context.new_page()
    phone.goto(link)

    heading(phone, "Please open this link on another device")
    expect(phone.get_by_role("button", name="Next")).to_have_count(0)
    press(phone, "Copy the link")
    expect(phone.get_by_role("status")).to_have_text("Copied ✓")
    assert phone.evaluate("navigator.clipboard.readText()") == link
    photograph(phone, "way-8-phone", resized=False)
    context.close()


def test_withdrawing_deletes_what_was_answered(
    page: Page, address: str, database: Database
) -> None:
    enter(page, address)
    hear(page, database)
    begin(page)
    take_trial(page, 1)
    expect_trial(page, 2)
    mine = study_session_of(page, database).id
    with database.reading() as session:
        before = [
            len(session.scalars(select(t)).all()) for t in (Response, WatchRecord, FormAnswer)
        ]

    page.get_by_role("link", name="withdraw").click()
    heading(page, "Withdraw from the study?")
    photograph(page, "way-9-withdraw")
    press(page, "Yes, withdraw")
    heading(page, "You have withdrawn")

    with database.reading() as session:
        after = [len(session.scalars(select(t)).all()) for t in (Response, WatchRecord, FormAnswer)]
        assert session.scalars(select(Trial).where(Trial.study_session_id == mine)).all() == []
    assert all(then < earlier for then, earlier in zip(after, before, strict=True))
    assert study_session_of(page, database).withdrawn_at is not None
