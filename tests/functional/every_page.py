"""A walk that comes to every page of a study, without watching what it shows."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

from flask import Flask
from playwright.sync_api import Page, expect

from studyapp.session.ending import advance
from studyapp.session.state import current_trial, find_study_session, update_row
from studyapp.web.site import site_of
from tests.functional.browsing import follow
from tests.functional.looking import expect_videos
from tests.functional.taking_part import answer, fill

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
            fill(page, site_of(app).database)
            follow(page.locator("form:visible button.primary"))


def kind_of(page: Page) -> str:
    """Return what the page is."""
    expect(page.locator(", ".join(KINDS)).first).to_be_attached()
    return next(kind for selector, kind in KINDS.items() if page.locator(selector).count())


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
