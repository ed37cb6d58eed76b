"""Every page of every protocol, looked at: barriers, light and dark, and whether a pair fits.

With ``SCREENSHOTS=folder`` in the environment each page is also taken in every size.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Page, expect

from tests.functional.browsing import IN_A_BROWSER, LAPTOP, launched, watched_page
from tests.functional.every_page import shown, walk
from tests.functional.shown_studies import NAMES, write_shown_study

pytestmark = IN_A_BROWSER

SIZES = {
    "laptop": LAPTOP,
    "desktop": {"width": 1920, "height": 1080},
    "phone": {"width": 390, "height": 844},
}
CONTRAST = {"runOnly": {"type": "rule", "values": ["color-contrast"]}}
SEVERE = ("serious", "critical")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with launched() as chromium:
        yield chromium


def barriers(page: Page) -> list[str]:
    """Return what axe-core finds severe on the page, light and dark."""
    found = []
    for scheme, options in (("dark", CONTRAST), ("light", {"resultTypes": ["violations"]})):
        page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
        results = Axe().run(page, options=options).response
        found += [
            f"{scheme}: {violation['id']} at {node['target']}: {node['failureSummary']}"
            for violation in results["violations"]
            if violation["impact"] in SEVERE
            for node in violation["nodes"]
        ]
    return found


def photograph(page: Page, name: str) -> None:
    """Take the page light and dark in every size, where screenshots are wanted."""
    if "SCREENSHOTS" not in os.environ:
        return
    folder = Path(os.environ["SCREENSHOTS"])
    folder.mkdir(parents=True, exist_ok=True)
    for size, viewport in SIZES.items():
        page.set_viewport_size(viewport)
        for scheme in ("dark", "light"):
            page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
            path = folder / f"{name}-{size}-{scheme}.png"
            page.screenshot(path=path, full_page=size == "phone")
    page.set_viewport_size(LAPTOP)


def made_of(page: Page) -> str:
    """Return what the page consists of: pages of the same parts look alike."""
    parts = "[...document.querySelectorAll('body *')].map(e => `${e.tagName}.${e.className}`)"
    return str(page.evaluate(f"[...new Set({parts})].sort().join(' ')"))


@pytest.mark.parametrize("name", NAMES)
def test_no_page_has_a_severe_barrier_in_light_or_dark(
    name: str, browser: Browser, tmp_path: Path
) -> None:
    write_shown_study(tmp_path / name, name)
    with shown(tmp_path / name) as (address, app), watched_page(browser, address) as page:
        found = {}
        seen = set()
        for state in walk(page, address, app):
            parts = made_of(page)
            if parts not in seen:
                photograph(page, f"{name}-{state}")
                found[state] = barriers(page)
            seen.add(parts)

    assert {state: each for state, each in found.items() if each} == {}
    assert "trial" in "".join(found)


@pytest.mark.parametrize("language", ["en", "de", "ja"])
@pytest.mark.parametrize("name", ["composed", "players"])
def test_a_pair_fits_a_laptop_and_no_page_is_wider_than_a_phone(
    name: str, language: str, browser: Browser, tmp_path: Path
) -> None:
    write_shown_study(tmp_path / name, name, language=language)
    with shown(tmp_path / name) as (address, app), watched_page(browser, address) as page:
        for state in walk(page, address, app):
            page.set_viewport_size(SIZES["phone"])
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), state
            page.set_viewport_size(LAPTOP)
            if state.endswith("trial"):
                break
        photograph(page, f"{name}-{language}")

        expect(page.locator("html")).to_have_attribute("lang", language)
        assert page.evaluate("document.documentElement.scrollHeight <= innerHeight")
        for video in page.locator("video").all():
            box = video.bounding_box()
            assert box is not None
            assert box["height"] >= 300
