"""The desk in a real browser: a lab's first study, uploads, and motion in 3D.

With ``SCREENSHOTS=folder`` in the environment each page is also taken in every size.
"""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from studyapp.desk.inbox import LARGEST_PIECE
from studyapp.study.folder import StudyFolder
from tests.functional.browsing import (
    IN_A_BROWSER,
    SOFTWARE_GRAPHICS,
    commanded,
    follow,
    launched,
    press,
    wait_until,
    watched_page,
)
from tests.functional.conftest import SECONDS
from tests.functional.desk_way import STUDY, walk_the_desk, write_recordings
from tests.functional.joining import join
from tests.functional.page_checks import (
    LAPTOP,
    SIZES,
    examination,
    participants_barriers,
    photograph,
    resize,
)
from tests.support.studies.takes import write_motion, write_speech

pytestmark = IN_A_BROWSER

LONG_SECONDS = 100
"""Of a recording that takes four pieces."""

Examine = Callable[[Page, str], None]


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with launched(*SOFTWARE_GRAPHICS) as chromium:
        yield chromium


def test_a_first_study_is_made_rehearsed_and_served_without_a_shell(
    browser: Browser, tmp_path: Path
) -> None:
    (tmp_path / "lab").mkdir()
    recordings = write_recordings(tmp_path / "recordings", seconds=SECONDS)
    with (
        examination("desk") as of_researchers,
        examination("desk", participants_barriers) as of_participants,
        commanded("desk", tmp_path / "lab") as (address, link),
        watched_page(browser, address, refused=422) as page,
        watched_page(browser, address) as visitor,
    ):
        looks: dict[str, Examine] = {
            "researchers": of_researchers,
            "participants": of_participants,
            "document": lambda page, name: photograph(page, f"desk-{name}"),
        }
        for stop in walk_the_desk(page, visitor, link, recordings, participants=2, size=160):
            looks[stop.kind](stop.page, stop.name)
        page.goto(f"{address}/{STUDY}/research/preview/0/1/1/")
        follow(page.get_by_role("link", name="Turn the motion around"))
        page.get_by_role("button", name="Play A").click()
        expect(page.locator(".motion-viewer canvas")).to_be_visible()
        of_researchers(page, "previewed-motion")
        follow(page.get_by_role("link", name="Back to the desk"))
        press(page, "Log out")
        page.goto(f"{address}/{STUDY}/research/")
        expect(page.get_by_label("Password")).to_be_visible()


def test_an_interrupted_upload_resumes_and_its_motion_is_shown_in_3d(
    browser: Browser, tiny_study_template: Path, tmp_path: Path
) -> None:
    lab = tmp_path / "lab"
    study = StudyFolder(Path(shutil.copytree(tiny_study_template, lab / "tiny")))
    for condition in ("mismatched", "broken"):
        write_motion(study.clip(condition, "take-0"), SECONDS)
    recording = write_speech(tmp_path / "long.wav", LONG_SECONDS)
    # There is no segment of the last one.
    motions = [write_motion(tmp_path / f"take-{number}.npz", SECONDS) for number in (0, 1, 2, 9)]
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
        _upload_long_recording(page, recording, examine)
        page.get_by_label("Condition").fill("rule_based")
        page.get_by_label("Files", exact=True).set_input_files(motions)
        press(page, "Upload")
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
        for cell in (
            *(f"motion of rule based for take-{n}" for n in range(3)),
            "missing of rule based for long",
        ):
            expect(page.get_by_role("link", name=cell)).to_be_visible()
        examine(page, "table")
        _turn_motion_around(page, examine)


def _upload_long_recording(page: Page, recording: Path, examine: Examine) -> None:
    """Upload a recording whose third chunk keeps getting lost, until the page is left."""
    assert recording.stat().st_size > 3 * LARGEST_PIECE
    pattern = f"**/uploads?*offset={2 * LARGEST_PIECE}"
    page.route(pattern, lambda route: route.abort("internetdisconnected"))
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
    press(page, "Upload")
    expect(page.get_by_text("choose it again to go on")).to_have_count(0)
    assert not any(f"offset={LARGEST_PIECE}" in url for url in sent)


def _turn_motion_around(page: Page, examine: Examine) -> None:
    """Go from the table to a segment in all conditions side by side, also on a phone."""
    follow(page.get_by_role("link", name="motion of broken for take-0"))
    page.get_by_role("button", name="Play rule based, mismatched, broken").click()
    viewer = page.locator(".motion-viewer")
    expect(viewer.locator(".labels b")).to_have_text(["rule based", "mismatched", "broken"])
    # It has played the motion to the end by itself.
    wait_until(page, lambda: float(viewer.get_attribute("data-seconds") or "0") >= SECONDS - 0.1)
    examine(page, "segment")
    resize(page, SIZES["phone"])
    page.reload()
    page.get_by_role("button", name="Play rule based, mismatched, broken").click()
    expect(viewer).to_have_attribute("data-rows", "2")
    resize(page, LAPTOP)
