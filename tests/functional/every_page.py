"""A walk that comes to every page of a study, without watching what it shows."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from secrets import token_hex

from flask import Flask
from playwright.sync_api import Page, expect
from sqlalchemy import select

from studyapp.database.tables import StudySession
from studyapp.session.arrivals import Arrival
from studyapp.session.comprehension import start_trials
from studyapp.session.ending import advance
from studyapp.session.enrolment import enrol
from studyapp.session.state import current_trial, find_study_session, update_row
from studyapp.web.app import create_app
from studyapp.web.site import site_of
from tests.functional.browsing import follow
from tests.functional.looking import expect_videos
from tests.support.servers.local_server import listening

KINDS = {
    "#answers": "trial",
    "#eligibility": "eligibility",
    "#start": "consent",
    "#sound-check": "sound-check",
    "#break": "break",
    "[action$='/begin']": "instructions",
    "[action*='/form/']": "form",
    "#completion-code": "completed",
}
"""What a page is, by something that only it holds; a new kind of page is one line here."""


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


def walk(page: Page, address: str, app: Flask) -> Iterator[str]:
    """Go from the first page to the completion code; give a name for each state of each page."""
    page.goto(address)
    for number in count(1):
        kind = kind_of(page)
        name = f"{number:02}-{kind}"
        if kind == "trial":
            expect(page.locator(".play").first).to_be_visible()
            expect_videos(page)
            yield name
            answer(page)
            yield f"{name}-answered"
            menus = page.locator(".ordering button")
            if menus.count() and not page.locator(".ranks:visible").count():
                menus.click()
                yield f"{name}-menus"
            leave_trial(page, app)
        else:
            yield name
            if kind == "completed":
                return
            fill(page, app)
            follow(page.locator("form:visible button.primary"))


def kind_of(page: Page) -> str:
    """Return what the page is."""
    expect(page.locator(", ".join(KINDS)).first).to_be_attached()
    return next(kind for selector, kind in KINDS.items() if page.locator(selector).count())


def answer(page: Page) -> None:
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


def leave_trial(page: Page, app: Flask) -> None:
    """Settle the trial behind the page's back, since nobody has watched it."""
    token = page.url.rsplit("/", 1)[1]
    site = site_of(app)
    with site.database.writing() as session:
        study_session = find_study_session(session, token)
        trial = current_trial(study_session)
        assert trial is not None
        update_row(session, trial, unplayable_at=site.clock.now())
        advance(session, study_session, site.study, site.clock.now())
    page.reload()
    expect(page.locator(f"#answers [name=trial][value='{trial.token}']")).to_have_count(0)


def fill(page: Page, app: Flask) -> None:
    """Fill in what a page asks about the participant."""
    for field in page.locator("form:visible .question").all():
        choices = field.locator("[type=radio]")
        if choices.count():
            choices.first.check()
        else:
            field.locator("input, textarea").fill("30")
    if page.locator("#digits").count():
        page.locator("#digits").fill(spoken_digits(page, app))


def spoken_digits(page: Page, app: Flask) -> str:
    """Return the digits that the participant whose page this is hears."""
    token = page.url.partition("/take/")[2].partition("/")[0]
    query = select(StudySession.sound_digits).where(StudySession.token == token)
    with site_of(app).database.reading() as session:
        return session.scalars(query).one()
