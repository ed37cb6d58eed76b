"""Every page of every protocol: barriers, weight, one look for all, and whether a pair fits.

A page's weight is everything transferred, including headers, to a browser without a cache; videos
and sound are not counted.

With ``SCREENSHOTS=folder`` in the environment each page is also taken in every size.
"""

from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from itertools import count
from pathlib import Path

import pytest
from flask import Flask
from playwright.sync_api import Browser, Page, Response, expect
from sqlalchemy import update

from studyapp.database.tables.study_session import StudySession
from studyapp.session.ending import advance
from studyapp.session.state import current_trial, find_study_session, update_row
from studyapp.web.language import language_of, speak
from studyapp.web.site import attach, site_of
from tests.functional.browsing import IN_A_BROWSER, follow, press, watched_page
from tests.functional.page_checks import (
    LAPTOP,
    SIZES,
    examination,
    expect_to_fit_a_phone,
    expect_videos,
    participants_barriers,
    photograph,
    resize,
    too_small_to_touch,
    video_sizes,
)
from tests.functional.shown_studies import NAMES, write_shown_study
from tests.functional.taking_part import (
    answer,
    begin_study,
    fill,
    first_trial,
    shown,
    study_session_of,
)

pytestmark = IN_A_BROWSER

HEAVIEST = {
    "eligibility": 19_500,
    "consent": 19_500,
    "sound-check": 17_000,
    "instructions": 17_500,
    "form": 18_500,
    "trial": 107_000,
}
"""Bytes that each page may weigh. Those of these studies weigh up to 18,900 where participants
arrive, 15,800 for the sound check, 17,100 for instructions and forms, and 104,000 for a trial."""

RESEARCHERS_ALONE = ("WebGLRenderer", "motion-viewer", "glTF", "DecompressionStream")
"""Words of the viewer that turns motion around, of its library, and of files of motion."""


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


SUBMITTED_TWICE = """form => [1, 2].map(
    () => form.dispatchEvent(new SubmitEvent("submit", { cancelable: true })))"""
"""What a double click does: of each time, whether the form would be sent."""


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
    """Settle the trial directly in the database, since nobody has watched it."""
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


def expect_heading(page: Page, words: str) -> None:
    expect(page.get_by_role("heading", level=1)).to_contain_text(words)


def made_of(page: Page) -> str:
    """Return the elements of the page: pages with the same elements look alike."""
    parts = "[...document.querySelectorAll('body *')].map(e => `${e.tagName}.${e.className}`)"
    return str(page.evaluate(f"[...new Set({parts})].sort().join(' ')"))


@pytest.fixture(scope="module")
def examined() -> set[str]:
    """Return the elements of all examined pages of any study."""
    return set()


def burdens(page: Page, kind: str, responses: list[Response]) -> list[str]:
    """Return in which respects a page exceeds its weight limits."""
    page.wait_for_load_state("networkidle")
    loaded = [each for each in responses if each.request.resource_type != "media"]
    weight = sum(map(bytes_of, loaded))
    heavy = [f"weighs {weight} bytes"] if weight > HEAVIEST[kind] else []
    return heavy + [f"{each.url} turns motion around" for each in loaded if turns_motion(each)]


def bytes_of(response: Response) -> int:
    sizes = response.request.sizes()
    return sizes["responseHeadersSize"] + sizes["responseBodySize"]


def turns_motion(response: Response) -> bool:
    """Tell whether a script turns motion around; it is fetched anew, as pages forget the text."""
    if response.request.resource_type != "script":
        return False
    text = response.frame.page.request.get(response.url).text()
    return any(word in text for word in RESEARCHERS_ALONE)


@pytest.mark.parametrize("name", NAMES)
def test_every_page_is_small_identical_for_all_and_accessible(
    name: str, examined: set[str], browser: Browser, tmp_path: Path
) -> None:
    write_shown_study(tmp_path / name, name)
    with shown(tmp_path / name) as (address, app), watched_page(browser, address) as page:
        problems: dict[str, list[str]] = {}
        kinds: set[str] = set()
        photographed: set[str] = set()
        responses: list[Response] = []
        network = page.context.new_cdp_session(page)
        network.send("Network.enable")
        network.send("Network.setCacheDisabled", {"cacheDisabled": True})
        page.on("response", lambda response: responses.append(response))
        for state in walk(page, address, app):
            kind = state.partition("-")[2]
            parts = kind + made_of(page)
            if parts not in photographed:
                photograph(page, f"{name}-{state}")
            if parts not in examined:
                # Whoever has come to a trial has nearly all of the next one.
                weight = [] if "trial" in kinds else burdens(page, kind, responses)
                problems[state] = weight + participants_barriers(page) + too_small_to_touch(page)
                for _larger in (False, True) if "trial" in kind else ():
                    assert len(video_sizes(page)) == 1, state
                    page.keyboard.press("l")
            responses.clear()
            kinds.add(kind)
            photographed.add(parts)
            examined.add(parts)

    assert {state: each for state, each in problems.items() if each} == {}
    assert {"consent", "trial", "completed"} <= kinds


def test_every_side_page_is_accessible_withdrawing_deletes_and_phones_are_offered_the_link(
    browser: Browser, tmp_path: Path
) -> None:
    write_shown_study(tmp_path / "players", "players")
    with (
        examination("beside", participants_barriers) as examine,
        shown(tmp_path / "players") as (address, app),
    ):
        # The browser logs an error for each refusal here.
        page = browser.new_context(viewport=LAPTOP).new_page()
        database = site_of(app).database
        page.goto(address)
        assert page.locator("#eligibility").evaluate(SUBMITTED_TWICE) == [True, False]
        page.goto(address)
        page.get_by_label("no", exact=True).check()
        press(page, "Next")
        expect_heading(page, "other participants")
        examine(page, "screened-out")
        page.goto(address)
        for form in ("#eligibility", "#start"):
            expect(page.locator(form)).to_be_visible()
            fill(page, database)
            page.locator("form:visible button.primary").click()
        expect(page.locator("#digits")).to_be_visible()
        page.locator("#digits").fill("12345")
        press(page, "Next")
        expect(page.get_by_role("alert")).to_contain_text("not the digits that were spoken")
        expect(page.locator("#unheard")).to_be_visible()
        examine(page, "unheard")
        fill(page, database)
        press(page, "Next")
        expect_heading(page, "about you")
        page.locator("form").evaluate("form => form.noValidate = true")
        press(page, "Next")
        expect(page.locator(".field-problem").first).to_be_visible()
        examine(page, "form-problem")
        page.goto(page.url.partition("/form/")[0])
        second = page.context.new_page()
        second.goto(page.url)
        expect(page.get_by_role("dialog")).to_be_visible()
        examine(page, "second-window")
        second.close()
        page.goto(page.url)
        follow(page.get_by_role("link", name="withdraw"))
        examine(page, "withdraw")
        left = study_session_of(page, database)
        press(page, "Yes, withdraw")
        expect_heading(page, "withdrawn")
        examine(page, "withdrawn")

        assert left.trials
        with database.reading() as session:
            stored = session.get_one(StudySession, left.id)
            assert stored.withdrawn_at is not None
            assert stored.trials == []
        page.context.close()

        link = f"{address}/?PROLIFIC_PID=p2"
        phone = browser.new_page(viewport=SIZES["phone"], is_mobile=True, has_touch=True)
        phone.context.grant_permissions(["clipboard-read", "clipboard-write"])
        phone.goto(link)

        expect_heading(phone, "on another device")
        expect(phone.get_by_role("button", name="Next")).to_have_count(0)
        phone.get_by_role("button", name="Copy the link").click()
        expect(phone.get_by_role("status")).to_have_text("Copied ✓")
        assert phone.evaluate("navigator.clipboard.readText()") == link
        photograph(phone, "beside-phone")
        assert participants_barriers(phone) == []
        phone.context.close()


def test_every_error_page_is_accessible(browser: Browser, tmp_path: Path) -> None:
    write_shown_study(tmp_path / "labels", "labels", participants=1)
    with (
        examination("trouble", participants_barriers) as examine,
        shown(tmp_path / "labels") as (address, app),
    ):
        page = browser.new_context(viewport=LAPTOP).new_page()
        page.goto(f"{address}/take/nobody")
        examine(page, "unknown")
        begin_study(page, address)
        # As a browser without scripts sends it.
        page.locator("#answers").evaluate("form => form.submit()")
        expect(page.locator("#problem")).to_contain_text("not answered yet")
        examine(page, "trial-problem")
        page.route("**/media/*", lambda route: route.abort())
        page.goto(page.url.removesuffix("/answers"))
        expect(page.locator(".fault").first).to_be_visible()
        page.locator(".trouble summary").click()
        examine(page, "trial-fault")
        refused = {"status": 422, "json": {"problem": "There is no sign yet."}}
        page.route("**/unplayable", lambda route: route.fulfill(**refused))
        resize(page, SIZES["phone"])
        page.get_by_role("button", name="This video does not play").first.click()
        expect(page.locator("#problem")).to_be_in_viewport()
        resize(page, LAPTOP)
        first = page.url
        page.goto(address)
        page.get_by_role("button", name="Go on with the study").click()
        page.wait_for_url(first)
        page.evaluate("sessionStorage.clear()")
        page.goto(address)
        expect_heading(page, "has all the participants")
        expect(page.locator("#returning")).to_be_hidden()
        examine(page, "full")
        with site_of(app).database.writing() as session:
            long_ago = datetime(2026, 1, 1, tzinfo=UTC)
            session.execute(update(StudySession).values(last_active_at=long_ago))
        page.goto(address)
        page.get_by_role("button", name="I agree").click()
        expect(page.get_by_role("button", name="Begin")).to_be_visible()
        page.goto(first)
        expect_heading(page, "taken in the meantime")
        examine(page, "lapsed")
        site = site_of(app)
        closed = site.study.model_copy(update={"open": False})
        attach(app, replace(site, served=replace(site.served, study=closed)))
        page.evaluate("sessionStorage.clear()")
        page.goto(address)
        expect_heading(page, "takes no new participants")
        examine(page, "closed")
        page.context.close()


CHECKLISTS = {
    "de": "Noch nötig: 6 Videos ansehen",
    "ja": "残り：動画6本の視聴",
    "en": "Still needed: watch 6 videos",
}


def in_every_language(page: Page, app: Flask) -> Iterator[str]:
    """Show the present page in one language after the other; the study's own comes last."""
    for language in CHECKLISTS:
        speak(app, language_of(language))
        page.reload()
        expect(page.locator("html")).to_have_attribute("lang", language)
        yield language


@pytest.mark.parametrize("name", ["composed", "players"])
def test_a_pair_fits_a_laptop_and_no_page_is_wider_than_a_phone(
    name: str, browser: Browser, tmp_path: Path
) -> None:
    write_shown_study(tmp_path / name, name)
    with shown(tmp_path / name) as (address, app), watched_page(browser, address) as page:
        for state in walk(page, address, app):
            for _language in in_every_language(page, app):
                expect_to_fit_a_phone(page)
            if state.endswith("trial"):
                break
        for language in in_every_language(page, app):
            expect(page.locator(".play").first).to_be_visible()
            expect_videos(page)
            photograph(page, f"{name}-{language}")
            assert page.evaluate("document.documentElement.scrollHeight <= innerHeight"), language
            assert min(height for _, height in video_sizes(page)) >= 300


CUT_OFF = "buttons => buttons.filter(button => button.scrollWidth > button.clientWidth).length"


def test_every_text_of_a_ranking_fits_a_laptop_and_a_tablet(
    browser: Browser, tmp_path: Path
) -> None:
    write_shown_study(tmp_path / "ranking", "ranking")
    with shown(tmp_path / "ranking") as (address, app), watched_page(browser, address) as page:
        first_trial(page, address, app)
        for language in in_every_language(page, app):
            missing, onward = page.locator("#watched"), page.locator("#next")
            expect(missing).to_contain_text("E")
            expect(page.locator("#needed")).to_contain_text(CHECKLISTS[language])
            expect_videos(page)
            photograph(page, f"ranking-{language}")
            for larger in (True, False):
                page.keyboard.press("l")
                rows = [place.bounding_box() for place in (missing, onward)]
                beside, button = (row for row in rows if row is not None)
                middle = beside["y"] + beside["height"] / 2
                assert button["y"] < middle < button["y"] + button["height"], (language, larger)
            resize(page, {"width": 1024, "height": 768})
            assert page.get_by_role("button").evaluate_all(CUT_OFF) == 0, language
            resize(page, LAPTOP)
