"""The page in a real browser: it fits, follows light and dark, and its tables can be sorted."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from analysis.report.page import write_report
from tests.analysis.report.subjects import subject_of
from tests.analysis.results.made_tables import pairwise_table, report_of
from tests.functional.browsing import IN_A_BROWSER, launched
from tests.functional.page_checks import LAPTOP, SIZES, resize

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report")
    report = report_of(pairwise_table(participants=6, segments=5), "pairwise", folder)
    return write_report(report, subject_of(report, origin="rehearsal"), folder)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with launched() as chromium:
        yield chromium


@pytest.fixture
def page(browser: Browser, written: Path) -> Iterator[Page]:
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.goto(written.as_uri())
    yield page
    page.close()


HIDDEN = """[...document.querySelectorAll('.scroll')].filter(e => e.scrollWidth > e.clientWidth)
  .map(e => [e.textContent, getComputedStyle(e).backgroundAttachment.includes('local')])"""


def test_tables_fit_a_laptop_and_shade_scrollable_edges(page: Page) -> None:
    resize(page, LAPTOP)
    assert page.evaluate(HIDDEN) == []
    resize(page, SIZES["phone"])
    found = page.evaluate(HIDDEN)
    assert found
    assert all(shaded for _, shaded in found)


@pytest.mark.parametrize("width", [1280, 390])
def test_the_page_loads_nothing_logs_no_error_fits_and_follows_light_and_dark(
    page: Page, written: Path, width: int
) -> None:
    asked: list[str] = []
    complaints: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.set_viewport_size({"width": width, "height": 800})
    page.reload()
    assert asked == [written.as_uri()]
    assert complaints == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    page.emulate_media(color_scheme="light")
    light = page.evaluate("getComputedStyle(document.body).backgroundColor")
    page.emulate_media(color_scheme="dark")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") != light


def test_a_table_is_sorted_numerically_by_click_and_keyboard(page: Page) -> None:
    table = page.locator("#flow ~ section table.sortable").filter(has=page.locator("[data-value]"))
    table = table.first
    index = table.evaluate(
        "t => [...t.tBodies[0].rows[0].cells].findIndex((c) => c.dataset.value !== undefined)"
    )
    column = table.locator("thead tr").last.locator("th").nth(index)

    def values() -> list[float]:
        cells = table.locator(f"tbody tr > :nth-child({index + 1})")
        return [float(cell.get_attribute("data-value") or "nan") for cell in cells.all()]

    given = values()
    assert len(given) > 1
    column.locator("button").click()
    expect(column).to_have_attribute("aria-sort", "ascending")
    assert values() == sorted(given)
    column.locator("button").press("Enter")
    expect(column).to_have_attribute("aria-sort", "descending")
    assert values() == sorted(given, reverse=True)
    column.locator("button").press("Enter")
    expect(column).not_to_have_attribute("aria-sort", re.compile(""))
    assert values() == given


def test_a_rehearsal_is_marked_on_every_screen_and_figure(page: Page) -> None:
    figures = page.locator(".picture svg")
    marked = figures.filter(has_text="no person answered")
    assert figures.count() == marked.count() > 2
    height = page.evaluate("document.documentElement.scrollHeight")
    assert height > 2000
    for top in range(0, height, 700):
        page.evaluate(f"window.scrollTo(0, {top})")
        box = page.locator(".banner").bounding_box()
        assert box is not None
        assert box["y"] == pytest.approx(0, abs=1)
