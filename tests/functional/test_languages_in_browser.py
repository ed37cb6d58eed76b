"""What scripts say is translated too, in a real browser."""

from __future__ import annotations

from pathlib import Path

import pytest
from flask import Flask
from playwright.sync_api import Browser, Page, expect

from studyapp.study.settings.study import Study
from studyapp.web.language import language_of, speak
from studyapp.web.site import site_of
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


def english(page: Page, study: Study) -> str:
    return left_in_english(PageReader(page.content()), study)


@pytest.mark.parametrize("folder", ["sliders", "ties"], indirect=True)
def test_scripts_say_nothing_that_is_not_translated(browser: Browser, folder: Path) -> None:
    with shown(folder) as (address, app), watched_page(browser, address) as page:
        speak(app, bracketed())
        first_trial(page, address, app)
        study = site_of(app).study
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


CHECKLISTS = {
    "de": ("Noch nötig: A und B ansehen, Frage 1", "Alles erledigt – drücken Sie auf „Weiter“"),
    "ja": ("残り：A、Bの視聴／質問1への回答", "完了しました。「次へ」を押してください"),
}


@pytest.mark.parametrize("folder", ["mismatch"], indirect=True)
def test_the_checklist_is_said_in_the_language_of_the_study(browser: Browser, folder: Path) -> None:
    def expect_checklist(page: Page, app: Flask, number: int) -> None:
        for code, words in CHECKLISTS.items():
            speak(app, language_of(code))
            page.reload()
            expect(page.locator("#needed")).to_have_text(words[number])
            # A pair and its question stand on a laptop's screen without scrolling.
            assert page.evaluate("document.documentElement.scrollHeight <= innerHeight")

    with shown(folder) as (address, app), watched_page(browser, address) as page:
        first_trial(page, address, app)
        expect_checklist(page, app, 0)
        for label in "AB":
            page.locator(f"[data-label={label}]").click()
            expect_watched(page, label)
        page.locator(".scale label").first.click()
        expect_checklist(page, app, 1)
