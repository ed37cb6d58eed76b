from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page

from renderer.figures.sheet import sheet_page
from tests.functional.browsing import IN_A_BROWSER, launched
from tests.renderer.figures.small_videos import CONDITIONS, sheet_of

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    """Return the sheet of two segments in Chromium."""
    with launched() as chromium:
        page = chromium.new_page(viewport={"width": 900, "height": 700})
        page.goto(written(tmp_path_factory.mktemp("sheet"), CONDITIONS).as_uri())
        yield page


def written(folder: Path, conditions: tuple[str, ...]) -> Path:
    file = folder / "index.html"
    file.write_text(sheet_page(sheet_of(conditions)), encoding="utf-8")
    return file


def rows(page: Page) -> list[str]:
    """Return the segments of the rows that are seen."""
    return [name.inner_text() for name in page.locator("tbody b").all() if name.is_visible()]


def test_rows_are_found_by_transcript_emotion_and_remark(page: Page) -> None:
    assert rows(page) == ["one", "two"]
    for words, result in (("straße", ["one"]), ("FEAR", ["two"]), ("robin", ["one", "two"])):
        page.fill("#words", words)
        assert rows(page) == result
    page.fill("#words", "")
    page.check("#remarked")
    assert rows(page) == ["two"]
    page.uncheck("#remarked")
    assert rows(page) == ["one", "two"]


def test_search_and_segments_stay_visible_when_scrolling(page: Page) -> None:
    page.locator("thead th").last.scroll_into_view_if_needed()
    assert page.evaluate("scrollX") > 500
    for place in ("#words", "tbody th >> nth=0"):
        box = page.locator(place).bounding_box()
        assert box is not None
        assert box["x"] >= 0


def test_the_sheet_fits_a_phone_and_a_laptop_or_hints_at_more_columns(
    page: Page, tmp_path: Path
) -> None:
    further = page.locator("#further")
    further.wait_for(state="visible")
    page.set_viewport_size({"width": 390, "height": 844})
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    further.wait_for(state="hidden")
    assert page.locator("td b").first.is_visible()

    page.goto(written(tmp_path, CONDITIONS[:4]).as_uri())
    page.set_viewport_size({"width": 1366, "height": 768})
    assert page.evaluate("document.documentElement.scrollWidth") == 1366
    further.wait_for(state="hidden")
