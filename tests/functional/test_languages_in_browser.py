"""What scripts say is translated too, in a real browser."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from studyapp.study.settings.study import Study
from studyapp.web.language import Language, language_of, speak
from studyapp.web.site import study_site
from tests.functional.browsing import IN_A_BROWSER, expect_watched, watched_page
from tests.functional.every_page import first_trial, shown
from tests.functional.shown_studies import write_shown_study
from tests.studyapp.web.brackets import bracketed, left_in_english
from tests.studyapp.web.page_reader import PageReader

pytestmark = IN_A_BROWSER


@pytest.fixture
def folder(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    write_shown_study(tmp_path / request.param, request.param)
    return Path(tmp_path / request.param)


@contextmanager
def in_language(browser: Browser, folder: Path, language: Language) -> Iterator[tuple[Page, Study]]:
    """Give the first trial of the study in `folder`, served in `language`."""
    with shown(folder) as (address, app), watched_page(browser, address) as page:
        speak(app, language)
        first_trial(page, address, app)
        with app.app_context():
            study = study_site().study
        yield page, study


def english(page: Page, study: Study) -> str:
    return left_in_english(PageReader(page.content()), study)


@pytest.mark.parametrize("folder", ["sliders", "ties"], indirect=True)
def test_scripts_say_nothing_that_is_not_translated(browser: Browser, folder: Path) -> None:
    with in_language(browser, folder, bracketed()) as (page, study):
        page.locator("#next").click()
        expect(page.locator("#needed")).to_have_class("asked")
        assert english(page, study) == ""

        for number, video in enumerate(page.locator("video").all()):
            page.locator(".play").nth(number).click()
            assert english(page, study) == ""
            expect_watched(page, str(video.get_attribute("data-label")))
        for slider in page.locator("[type=number]").all():
            slider.fill("70")
        for menu in page.locator(".ranks select").all():
            menu.select_option("1", force=True)
        assert english(page, study) == ""


@pytest.mark.parametrize("folder", ["mismatch"], indirect=True)
@pytest.mark.parametrize(
    ("code", "still", "done"),
    [
        ("de", "Noch nötig: A und B ansehen, Frage 1", "Alles erledigt – drücken Sie auf „Weiter“"),
        ("ja", "残り：A、Bの視聴／質問1への回答", "完了しました。「次へ」を押してください"),
    ],
)
def test_the_checklist_is_said_in_the_language_of_the_study(
    browser: Browser, folder: Path, code: str, still: str, done: str
) -> None:
    with in_language(browser, folder, language_of(code)) as (page, _):
        expect(page.locator("#needed")).to_have_text(still)
        # A pair and its question stand on a laptop's screen without scrolling.
        assert page.evaluate("document.documentElement.scrollHeight <= innerHeight")
        for label in "AB":
            page.locator(f"[data-label={label}]").click()
            expect_watched(page, label)
        page.locator(".scale label").first.click()
        expect(page.locator("#needed")).to_have_text(done)
