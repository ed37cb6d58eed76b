"""Bringing files into a study in a real browser: an upload that stops, goes on, and fills a table.

With ``SCREENSHOTS=folder`` in the environment each page is also taken in every size.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, Route, expect

from studyapp.desk.inbox import LARGEST_PIECE
from tests.functional.browsing import IN_A_BROWSER, commanded, follow, press, watched_page
from tests.functional.joining import join
from tests.functional.looking import examination
from tests.support.studies.takes import write_motion, write_speech

pytestmark = IN_A_BROWSER

SECONDS = 100
"""Of a recording that takes four pieces."""


@pytest.fixture
def files(tmp_path: Path) -> Path:
    """Return a folder of a long recording, three motions of segments, and one of none."""
    folder = tmp_path / "files"
    folder.mkdir()
    write_speech(folder / "long.wav", SECONDS)
    for name in ("take-0", "take-1", "take-2", "take-9"):
        write_motion(folder / f"{name}.npz", 1.0)
    return folder


def test_files_are_uploaded_through_an_interruption_and_fill_the_table(
    browser: Browser, lab: Path, files: Path
) -> None:
    with (
        examination("bring-in") as examine,
        commanded("desk", lab) as (address, link),
        watched_page(browser, address) as page,
    ):
        page.on("dialog", lambda dialog: dialog.accept())
        join(page, link)
        press(page, "Take over tiny")
        follow(page.get_by_role("link", name="Bring in"))
        examine(page, "empty")
        _upload_long_recording(page, files / "long.wav", examine)
        page.get_by_label("Condition").fill("rule_based")
        page.get_by_label("Files", exact=True).set_input_files(sorted(files.glob("*.npz")))
        with page.expect_navigation():
            page.get_by_role("button", name="Upload").click()
        expect(page.get_by_role("row")).to_have_count(1 + 5)
        examine(page, "uploaded")
        page.get_by_label("Speaker").fill("Robin")
        page.get_by_label("Emotion").select_option("neutral")
        press(page, "Bring into the study")
        expect(page.get_by_role("status")).to_contain_text("Failed")
        examine(page, "job")
        page.goto(f"{address}/research/studies/tiny/bring-in")
        expect(page.get_by_text("there is no segment 'take-9'")).to_be_visible()
        examine(page, "refused")
        press(page, "Remove take-9.npz")
        expect(page.get_by_text("Nothing is waiting.")).to_be_visible()
        follow(page.get_by_role("link", name="All segments and conditions"))
        for name in ("take-0", "take-1", "take-2"):
            expect(
                page.get_by_role("link", name=f"motion of rule based for {name}")
            ).to_be_visible()
        missing = page.get_by_role("link", name="missing of rule based for long")
        expect(missing).to_be_visible()
        examine(page, "table")
        follow(page.get_by_role("link", name="motion of rule based for take-0"))
        examine(page, "clip")


def _upload_long_recording(
    page: Page, recording: Path, examine: Callable[[Page, str], None]
) -> None:
    """Upload a recording whose third piece is lost, again and again, until the page is left."""
    assert recording.stat().st_size > 3 * LARGEST_PIECE
    pattern = f"**/uploads?*offset={2 * LARGEST_PIECE}"

    def lose(route: Route) -> None:
        route.abort("internetdisconnected")

    page.route(pattern, lose)
    page.get_by_label("Files", exact=True).set_input_files(recording)
    page.get_by_role("button", name="Upload").click()
    expect(page.get_by_text("Waiting for the server")).to_be_visible()
    examine(page, "waiting")
    page.unroute(pattern)
    page.reload()
    expect(page.get_by_text("choose it again to go on")).to_be_visible()
    sent: list[str] = []
    page.on("request", lambda request: sent.append(request.url))
    page.get_by_label("Files", exact=True).set_input_files(recording)
    with page.expect_navigation():
        page.get_by_role("button", name="Upload").click()
    expect(page.get_by_text("choose it again to go on")).to_have_count(0)
    assert not any("offset=0" in url for url in sent)
