"""Checks of a page: in every size, light and dark, and with axe-core."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final, Literal

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, ViewportSize, expect

LAPTOP: ViewportSize = {"width": 1366, "height": 768}
SIZES: dict[str, ViewportSize] = {
    "laptop": LAPTOP,
    "desktop": {"width": 1920, "height": 1080},
    "phone": {"width": 390, "height": 844},
}
CONTRAST: dict[str, object] = {"runOnly": {"type": "rule", "values": ["color-contrast"]}}
EVERYTHING: dict[str, object] = {"resultTypes": ["violations"]}
SEVERE = ("serious", "critical")
SCHEMES: Final[tuple[Literal["dark", "light"], ...]] = ("dark", "light")
COLOURS = """[...document.querySelectorAll('*')].map(element => {
  const style = getComputedStyle(element);
  return [style.color, style.backgroundColor, style.borderTopColor, style.colorScheme].join();
})"""
CHOICES = "button, select, .scale label, .reasons label, .place, .slider input"
LOOKS = 10
"""The most comparisons of a page's colours before they count as different."""
LEAST_HEIGHT = 44
"""Smallest height of a touch target on a phone, in pixels."""

LOW_CHOICES = """(choices, least) => choices
  .filter(choice => choice.checkVisibility({ visibilityProperty: true }))
  .map(choice => [choice.innerText, choice.getBoundingClientRect().height])
  .filter(([, height]) => 0 < height && height < least)
  .map(([text, height]) => `${text} is ${height} pixels high`)"""


def resize(page: Page, size: ViewportSize) -> None:
    """Resize the window, and wait until the page has noticed."""
    page.set_viewport_size(size)
    expect(page.locator("html")).to_have_js_property("clientWidth", size["width"])


def expect_to_fit_a_phone(page: Page) -> None:
    """Wait until the page is no wider than a telephone; then restore a laptop's width."""
    resize(page, SIZES["phone"])
    html = page.locator("html")
    expect(html).to_have_js_property("scrollWidth", SIZES["phone"]["width"])
    resize(page, LAPTOP)


def photograph(page: Page, name: str, *, resized: bool = True) -> None:
    """Take a screenshot of the page if screenshots are requested.

    In every size, light and dark, and left light and as wide as a laptop; or once, as it is.
    """
    if "SCREENSHOTS" not in os.environ:
        return
    folder = Path(os.environ["SCREENSHOTS"])
    folder.mkdir(parents=True, exist_ok=True)
    if not resized:
        page.screenshot(path=folder / f"{name}.png")
        return
    for size, viewport in SIZES.items():
        resize(page, viewport)
        for scheme in SCHEMES:
            page.emulate_media(color_scheme=scheme)
            path = folder / f"{name}-{size}-{scheme}.png"
            page.screenshot(path=path, full_page=size == "phone")
    resize(page, LAPTOP)


def barriers(page: Page) -> list[str]:
    """Return what axe-core finds severe on the page, light and dark."""
    page.wait_for_load_state()
    problems = []
    for scheme, options in zip(SCHEMES, (CONTRAST, EVERYTHING), strict=True):
        page.emulate_media(color_scheme=scheme)
        problems += [f"{scheme}: {each}" for each in _severe(page, options)]
    return problems


@contextmanager
def examination(
    prefix: str, look: Callable[[Page], list[str]] = barriers
) -> Iterator[Callable[[Page, str], None]]:
    """Give a function that examines a page and takes its screenshot under a name; no page may have
    a problem.

    Parameters
    ----------
    prefix : str
        The beginning of the pictures' names.
    look : callable
        What finds problems of a page: of researchers' pages unless it is another one.
    """
    problems: dict[str, list[str]] = {}

    def examine(page: Page, name: str) -> None:
        photograph(page, f"{prefix}-{name}")
        problems[name] = look(page)
        expect_to_fit_a_phone(page)

    yield examine
    assert {name: each for name, each in problems.items() if each} == {}


def _severe(page: Page, options: dict[str, object]) -> list[str]:
    return [
        f"{violation['id']} at {node['target']}: {node['failureSummary']}"
        for violation in Axe().run(page, options=options).response["violations"]
        if violation["impact"] in SEVERE
        for node in violation["nodes"]
    ]


def participants_barriers(page: Page) -> list[str]:
    """Return what axe-core finds severe on a participant's page, which knows no dark look."""
    page.wait_for_load_state()
    # While a page still changes by itself, two moments differ; a dark look differs at all times.
    alike = any(_looks_alike(page) for _ in range(LOOKS))
    problems = [f"light: {each}" for each in _severe(page, EVERYTHING)]
    return problems + ([] if alike else ["another look in the dark"])


def _looks_alike(page: Page) -> bool:
    """Tell whether all colours of the page are the same in the dark and in the light."""
    looks = []
    for scheme in SCHEMES:
        page.emulate_media(color_scheme=scheme)
        looks.append(page.evaluate(COLOURS))
    dark, light = looks
    return bool(dark == light)


def too_small_to_touch(page: Page) -> list[str]:
    """Return what can be chosen or pressed on the page and is too low on a telephone."""
    size = page.viewport_size
    assert size is not None
    resize(page, SIZES["phone"])
    low: list[str] = page.locator(CHOICES).evaluate_all(LOW_CHOICES, LEAST_HEIGHT)
    resize(page, size)
    return low


def expect_videos(page: Page) -> None:
    """Wait until every video of the page is known so far that it has its size."""
    for video in page.locator("video").all():
        expect(video).not_to_have_js_property("readyState", 0)


def video_sizes(page: Page) -> set[tuple[int, int]]:
    """Return how large the videos of the page are, in pixels: one size if all are alike."""
    expect_videos(page)
    boxes = [video.bounding_box() for video in page.locator("video").all()]
    return {(round(box["width"]), round(box["height"])) for box in boxes if box is not None}
