"""Sliders without a preset, answered in a real browser."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from flask import Flask
from playwright.sync_api import Browser, Locator, Page, expect

from tests.functional.browsing import IN_A_BROWSER, watched_page
from tests.functional.every_page import first_trial, shown
from tests.functional.shown_studies import write_shown_study

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Flask]]:
    folder: Path = tmp_path_factory.mktemp("sliders") / "study"
    write_shown_study(folder, "sliders")
    with shown(folder) as study:
        yield study


@pytest.fixture
def page(browser: Browser, served: tuple[str, Flask]) -> Iterator[Page]:
    with watched_page(browser, served[0]) as opened:
        begin(opened, served)
        yield opened


def begin(page: Page, served: tuple[str, Flask]) -> None:
    first_trial(page, *served)
    expect(line(page)).to_be_visible()


def line(page: Page, number: int = 0) -> Locator:
    return page.locator(".slider [type=range]").nth(number)


def field(page: Page, number: int = 0) -> Locator:
    return page.locator(".slider [type=number]").nth(number)


def test_nothing_is_chosen_before_anybody_does(page: Page) -> None:
    expect(line(page)).to_have_attribute("aria-valuetext", "nothing chosen yet")
    expect(field(page)).to_have_value("")
    expect(page.locator(".bands .chosen")).to_have_count(0)
    line(page).focus()
    page.keyboard.press("Tab")
    expect(field(page)).to_have_value("")


def test_the_first_key_begins_in_the_middle_or_at_an_end(page: Page) -> None:
    keys = {
        "ArrowLeft": ("50", "49"),
        "ArrowUp": ("50", "51"),
        "PageDown": ("50", "40"),
        "Home": ("0", "0"),
        "End": ("100", "100"),
    }
    for number, (key, values) in enumerate(keys.items()):
        for value in values:
            line(page, number).press(key)
            expect(field(page, number)).to_have_value(value)


def test_what_was_chosen_is_shown_and_outlives_a_reload(page: Page) -> None:
    field(page).fill("85")
    field(page).press("Tab")
    expect(line(page)).to_have_attribute("aria-valuetext", "85, excellent")
    expect(page.locator(".bands .chosen")).to_have_text("excellent")

    page.reload()

    expect(field(page)).to_have_value("85")
    expect(line(page)).to_have_value("85")
    expect(line(page)).to_have_attribute("aria-valuetext", "85, excellent")


def test_a_press_or_a_touch_chooses_where_it_falls(
    page: Page, browser: Browser, served: tuple[str, Flask]
) -> None:
    box = line(page).bounding_box()
    assert box is not None
    line(page).click(position={"x": box["width"] * 0.25, "y": box["height"] / 2})
    assert 23 <= int(field(page).input_value()) <= 27
    line(page, 1).click()
    expect(field(page, 1)).to_have_value("50")

    touched = browser.new_context(has_touch=True).new_page()
    begin(touched, served)
    box = line(touched).bounding_box()
    assert box is not None
    line(touched).tap(position={"x": box["width"] * 0.8, "y": box["height"] / 2})
    assert 78 <= int(field(touched).input_value()) <= 82
    touched.context.close()
