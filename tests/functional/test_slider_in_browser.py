"""A slider without a preset, answered in a real browser."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import expect

from tests.finished_study import write_finished_study, write_short_video
from tests.functional.browsing import (
    IN_A_BROWSER,
    launched,
    photograph,
    screenshots_folder,
    serving,
    watched_page,
)

pytestmark = IN_A_BROWSER


def test_a_slider_is_chosen_by_keys_and_outlives_a_reload(tmp_path: Path) -> None:
    folder = tmp_path / "rating"
    folder.mkdir()
    write_short_video(tmp_path / "short.mp4", seconds=1.0)
    write_finished_study(folder, "rating", tmp_path / "short.mp4")
    with (
        serving(folder) as address,
        launched() as browser,
        watched_page(browser, address) as page,
    ):
        page.goto(address)
        page.get_by_role("button", name="I agree").click()
        page.get_by_role("button", name="Begin").click()
        line = page.get_by_role("slider", name="Question").first
        number = page.locator(".slider [type=number]").first
        expect(line).to_have_attribute("aria-valuetext", "nothing chosen yet")
        expect(number).to_have_value("")

        line.press("PageDown")

        expect(number).to_have_value("40")
        photograph(page, screenshots_folder(tmp_path), "slider")
        page.reload()
        expect(number).to_have_value("40")
        expect(line).to_have_value("40")
