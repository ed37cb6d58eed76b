"""What participants load before anything plays: little, and nothing of what only researchers see.

A page's weight is what comes over the line, headers too, in a browser that has never been here;
what is played on it is not counted.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, Response

from tests.functional.browsing import IN_A_BROWSER, watched_page
from tests.functional.every_page import shown, walk
from tests.functional.shown_studies import write_shown_study
from tests.support.studies.redefining import redefine

pytestmark = IN_A_BROWSER

HEAVIEST = {
    "eligibility": 24_000,
    "consent": 24_000,
    "sound-check": 7_000,
    "instructions": 6_000,
    "form": 6_000,
    "trial": 105_000,
}
"""Bytes that each page may weigh. Those of these studies weigh up to 20,900 where participants
arrive, 5,900 for the sound check, 4,900 for instructions and forms, and 94,600 for a trial."""

RESEARCHERS_ALONE = ("WebGLRenderer", "motion-viewer", "glTF", "DecompressionStream")
"""Words of the viewer that turns motion around, of its library, and of files of motion."""


@pytest.mark.parametrize("name", ["composed", "players", "sliders", "ranking", "mismatch"])
def test_pages_before_the_first_video_are_light_and_turn_no_motion_around(
    name: str, browser: Browser, tmp_path: Path
) -> None:
    write_shown_study(tmp_path / name, name)
    if name != "players":
        redefine(tmp_path / name, ("[page]", "[page]\nsound_check = true"))
    weights: dict[str, int] = {}
    betraying: list[str] = []
    with shown(tmp_path / name) as (address, app), watched_page(browser, address) as page:
        loaded: list[Response] = []
        page.on("response", lambda response: loaded.append(response))
        for state in walk(page, address, app):
            page.wait_for_load_state("networkidle")
            weighed = [each for each in loaded if each.request.resource_type != "media"]
            loaded.clear()
            weights[state.partition("-")[2]] = sum(map(weight, weighed))
            betraying += [each.url for each in weighed if turns_motion(page, each)]
            if state.endswith("trial"):
                break
    assert betraying == []
    assert {"consent", "sound-check", "trial"} <= set(weights)
    assert {kind: each for kind, each in weights.items() if each > HEAVIEST[kind]} == {}


def weight(response: Response) -> int:
    sizes = response.request.sizes()
    return sizes["responseHeadersSize"] + sizes["responseBodySize"]


def turns_motion(page: Page, response: Response) -> bool:
    """Tell whether a script turns motion around; it is fetched anew, as pages forget the text."""
    if response.request.resource_type != "script":
        return False
    text = page.request.get(response.url).text()
    return any(word in text for word in RESEARCHERS_ALONE)
