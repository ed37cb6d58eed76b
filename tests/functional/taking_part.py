"""What a participant does on the pages of a study, in a real browser."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from secrets import token_hex

from flask import Flask
from playwright.sync_api import Frame, Locator, Page, expect
from sqlalchemy import select
from sqlalchemy.orm import selectinload

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Trial
from studyapp.session.enrolment import Arrival, enrol
from studyapp.session.form_answers import start_trials
from studyapp.web.app import create_app
from studyapp.web.site import site_of
from tests.functional.browsing import PATIENCE_MS
from tests.functional.page_checks import expect_videos
from tests.support.servers.local_server import listening

WATCHED = "Watched ✓"
MOST_TIMES = 5
AWAIT_END = """(video, patience) => {
    window.ended = new Promise((end, fail) => {
        for (const name of ["ended", "emptied"]) {
            video.addEventListener(name, () => end(true), {once: true});
        }
        setTimeout(() => {
            const {currentSrc, currentTime, paused, error} = video;
            const state = {currentSrc, currentTime, paused, error: error?.message};
            fail(new Error(`this video did not end: ${JSON.stringify(state)}`));
        }, patience);
    });
}"""
"""Ends with the video, or when another copy takes its place: that one is to be played anew."""


@contextmanager
def shown(study: Path) -> Iterator[tuple[str, Flask]]:
    """Serve the study from a thread; give its address and the application."""
    app = create_app(study)
    try:
        with listening(app) as address:
            yield address, app
    finally:
        site_of(app).database.close()


def first_trial(page: Page, address: str, app: Flask) -> None:
    """Show the first trial of a participant who has agreed and read the instructions elsewhere."""
    site = site_of(app)
    token = enrol(site.database, site.served, Arrival(visit=token_hex(16)), site.clock)
    start_trials(site.database, site.served, token, site.clock)
    page.goto(f"{address}/take/{token}")
    expect(page.locator(".play").first).to_be_visible()
    expect_videos(page)


def begin_study(page: Page | Frame, address: str) -> None:
    """Go to the first trial of a study that asks nothing before it, and wait for its players."""
    page.goto(address)
    page.get_by_role("button", name="I agree").click()
    page.get_by_role("button", name="Begin").click()
    expect(page.locator(".play").first).to_be_visible()


def expect_trial(page: Page | Frame, number: int) -> None:
    """Wait until the page shows the trial of that number."""
    expect(page.locator(".progress")).to_contain_text(f"Trial {number} of ")


def watch(page: Page | Frame) -> None:
    """Play one video after the other to its end, and see that no two ever play at once.

    If the machine was too busy to show a part, the page says so, and the video is played again.
    """
    watched = page.locator("#watched")
    expect(watched).not_to_be_empty()
    for _time in range(MOST_TIMES):
        if watched.inner_text() == WATCHED:
            return
        for number, video in enumerate(page.locator("video").all()):
            label = video.get_attribute("data-label") or ""
            if re.search(rf"\b{label}\b", watched.inner_text()):
                video.evaluate(AWAIT_END, PATIENCE_MS)
                page.locator(".play").nth(number).click()
                assert page.evaluate("window.ended"), "another page was shown meanwhile"
                assert page.locator(".playing").count() <= 1
    expect(watched).to_have_text(WATCHED)


def answer(page: Page | Frame) -> None:
    """Answer every question in the way of its widget."""
    for question in page.locator("#answers .question").all():
        cards = question.locator(".card:visible")
        menus = question.locator("select:visible")
        line = question.get_by_role("slider")
        if cards.count():
            for _card in range(cards.count()):
                question.locator(".tray .card").last.click()
        elif menus.count():
            for number, menu in enumerate(menus.all(), start=1):
                menu.select_option(str(number))
        elif line.count():
            line.press("PageUp")
            line.press("PageUp")
        else:
            question.locator(".scale label").nth(1).click()


def take_trial(page: Page | Frame, number: int) -> None:
    """Watch all videos of the trial of that number, answer all its questions, and go on."""
    expect_trial(page, number)
    watch(page)
    answer(page)
    expect(page.locator("#needed")).to_have_text("All done – press Next")
    page.locator("#next").click()


def fill(page: Page, database: Database) -> None:
    """Fill in what a page asks about the participant."""
    for field in page.locator("form:visible .question").all():
        choices = field.locator("[type=radio]")
        if choices.count():
            choices.first.check()
        else:
            field.locator("input, textarea").fill("30")
    if page.locator("#digits").count():
        page.locator("#digits").fill(study_session_of(page, database).sound_digits)


def study_session_of(page: Page, database: Database) -> StudySession:
    """Return the stored data of this page's participant, with trials and answers."""
    token = page.url.partition("/take/")[2].partition("/")[0]
    trials = selectinload(StudySession.trials)
    stored = select(StudySession).where(StudySession.token == token)
    stored = stored.options(trials.selectinload(Trial.videos), trials.selectinload(Trial.responses))
    with database.reading() as session:
        return session.scalars(stored).one()


def answers_of(page: Page, database: Database) -> list[tuple[int, str, int]]:
    """Return the answers of this page's participant: trial, question and value."""
    return sorted(
        (trial.position, response.question, response.value)
        for trial in study_session_of(page, database).trials
        for response in trial.responses
    )


def expect_playing(page: Page, name: str) -> None:
    """Wait until the player `name` plays, and no other."""
    expect(page.locator(f".playing[aria-label='{name}']")).to_have_count(1)
    expect(page.locator(".playing")).to_have_count(1)


@contextmanager
def playing_on(*videos: Locator) -> Iterator[None]:
    """Let videos loop: however busy the machine, only the page stops them."""
    for video in videos:
        video.evaluate("video => { video.loop = true; }")
    yield
    for video in videos:
        video.evaluate("video => { video.loop = false; }")
