"""What a browser proves to have been watched, and what a participant does when a video fails."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, Response, Route, expect
from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables import Video
from tests.functional.browsing import (
    IN_A_BROWSER,
    PATIENCE_MS,
    begin_study,
    expect_playing,
    expect_trial,
    expect_watched,
    follow,
    playing_on,
    study_session_of,
    wait_until,
)
from tests.support.studies.finished_study import write_finished_study, write_short_video
from tests.support.studies.redefining import redefine

pytestmark = IN_A_BROWSER

FORCED_RATE = """video => {
  const rate = Object.getOwnPropertyDescriptor(HTMLMediaElement.prototype, "playbackRate");
  rate.set.call(video, 4);
  Object.defineProperty(video, "playbackRate", { get() { return 4; }, set() {} });
}"""
"""A browser extension that makes videos faster, and does not let the page change it."""

RELOADED_MEANWHILE = """video => video.addEventListener("timeupdate", () => {
  if (video.currentTime > 0.1) location.reload();
})"""
"""Somebody who reloads the page while a video plays, surely before its end."""

BUSY_AS_IT_BEGINS = """button => {
  const end = performance.now() + 500;
  button.click();
  while (performance.now() < end);
}"""

PRETENDED_HIDDEN = """() => {
  Object.defineProperty(document, "hidden", { get: () => true });
  document.dispatchEvent(new Event("visibilitychange"));
}"""


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a study of two players a trial, with places for all these tests."""
    folder = tmp_path_factory.mktemp("watching") / "study"
    folder.mkdir()
    video = folder.parent / "short.mp4"
    write_short_video(video, seconds=1.0)
    write_finished_study(folder, "pairwise", video)
    redefine(folder, ("participants = 3", "participants = 30"))
    return folder


def player(page: Page, label: str) -> Locator:
    return page.get_by_role("region", name=f"Video {label}")


def play_button(page: Page, label: str) -> Locator:
    return page.get_by_role("button", name=f"Play {label}", exact=True)


def is_enough(response: Response) -> bool:
    """Tell whether the server has now seen enough of a video."""
    return "/watched/" in response.url and response.json()["missing"] == 0


def reports_of(page: Page) -> list[dict[str, Any]]:
    """Return a list that fills with what the page reports."""
    reports: list[dict[str, Any]] = []

    def look_at(request: Any) -> None:
        if "/watched/" in request.url:
            reports.append(json.loads(request.post_data))

    page.on("request", look_at)
    return reports


def played_at(reports: list[dict[str, Any]]) -> set[float]:
    """Return how fast the videos played; a busy machine also reports that one did not."""
    return {report["rate"] for report in reports if report["intervals"]}


def played(database: Database, video_token: str) -> float:
    """Return the seconds that all reports of a video tell of, each part as often as it is told."""
    with database.reading() as session:
        video = session.scalars(select(Video).where(Video.token == video_token)).one()
        return 0.0 if video.watch_record is None else video.watch_record.played_seconds


def test_playing_faster_does_not_count_and_says_so(
    page: Page, address: str, database: Database
) -> None:
    begin_study(page, address)
    reports = reports_of(page)
    video = player(page, "A").locator("video")
    video.evaluate(FORCED_RATE)

    def tells_of_playing(response: Response) -> bool:
        return "/watched/" in response.url and bool(played_at(reports))

    with page.expect_response(tells_of_playing) as answered:
        play_button(page, "A").click()

    expect(page.locator("#watched")).to_have_text("Please let the video play at normal speed")
    expect(page.locator("#needed")).to_contain_text("Still needed: watch A and B")
    assert played_at(reports) == {4}
    assert answered.value.json()["intervals"] == []
    assert answered.value.json()["missing"] > 0.9


def test_playing_out_of_view_does_not_count_and_says_so(page: Page, address: str) -> None:
    begin_study(page, address)
    reports = reports_of(page)
    page.evaluate(PRETENDED_HIDDEN)

    def all_told(response: Response) -> bool:
        hidden = sum(report["hidden_seconds"] for report in reports)
        return "/watched/" in response.url and hidden > 0.5

    with page.expect_response(all_told) as answered:
        play_button(page, "A").click()

    expect(page.locator("#watched")).to_have_text("Please keep the video in view while it plays")
    assert answered.value.json()["intervals"] == []


def test_frames_are_reported_with_what_was_played(
    page: Page, address: str, database: Database
) -> None:
    begin_study(page, address)

    with page.expect_response(is_enough) as answered:
        play_button(page, "A").click()

    token = answered.value.url.rsplit("/", 1)[1]
    with database.reading() as session:
        video = session.scalars(select(Video).where(Video.token == token)).one()
        record = video.watch_record
        assert record is not None
        assert (record.rate, record.hidden_seconds + record.silent_seconds) == (1, 0)
        assert record.frames is not None
        assert record.frames > 0
        assert record.dropped_frames is not None


def test_what_plays_while_the_page_is_busy_counts(page: Page, address: str) -> None:
    begin_study(page, address)
    expect(player(page, "A").locator("video")).to_have_js_property("readyState", 4)

    play_button(page, "A").evaluate(BUSY_AS_IT_BEGINS)

    expect(page.locator("#watched")).to_have_text("Still to watch: B")


def test_a_refresh_in_the_middle_of_playing_keeps_what_was_played(page: Page, address: str) -> None:
    begin_study(page, address)
    player(page, "A").locator("video").evaluate(RELOADED_MEANWHILE)
    follow(play_button(page, "A"))

    # Without what was played, A would be as unwatched as B, and no seconds would be told. While the
    # page is asked for, the video may come to its end.
    expect(page.locator("#watched")).to_have_text(re.compile(r"^Still to watch: (A 1 s · )?B$"))


def test_a_broken_video_is_named_and_the_trial_left(
    page: Page, address: str, database: Database
) -> None:
    page.goto(address)
    broken: list[str] = []

    def break_one(route: Route) -> None:
        token = route.request.url.split("/media/")[1].split(".mp4")[0]
        if token in broken:
            route.fetch()
            route.fulfill(status=200, content_type="video/mp4", body="no video")
        else:
            route.continue_()

    page.route("**/media/**", break_one)
    follow(page.get_by_role("button", name="I agree"))
    trial = study_session_of(page, database).trials[0]
    second = trial.videos[1].token
    broken.append(second)
    page.get_by_role("button", name="Begin").click()

    trouble = player(page, "B").get_by_role("alert")
    expect(trouble).to_have_text("This video cannot be played.")
    expect(player(page, "A").get_by_role("alert")).to_be_hidden()
    button = player(page, "B").get_by_role("button", name="This video does not play")
    button.focus()
    page.keyboard.press("Enter")

    expect_trial(page, 2)
    with database.reading() as session:
        videos = session.scalars(select(Video).where(Video.trial_id == trial.id)).all()
        assert {v.token for v in videos if v.unplayable_at is not None} == {second}


def test_a_broken_video_that_loads_again_plays(page: Page, address: str) -> None:
    page.route("**/media/*.mp4", lambda route: route.fulfill(status=200, body="no video"))
    begin_study(page, address)
    expect(player(page, "A").get_by_role("alert")).to_be_visible()
    page.unroute("**/media/*.mp4")

    player(page, "A").get_by_role("button", name="Reload this video").click()

    expect(player(page, "A").get_by_role("alert")).to_be_hidden()
    expect(play_button(page, "A")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.locator("#watched")).to_have_text("Still to watch: B")


def test_a_video_that_gets_no_data_says_so_and_plays_when_it_is_loaded_again(
    page: Page, address: str, database: Database
) -> None:
    # A video that is loaded again has another address.
    unanswered: list[Route] = []
    page.route("**/media/*.mp4", lambda route: unanswered.append(route))
    begin_study(page, address)
    reports = reports_of(page)

    play_button(page, "A").click()
    trouble = player(page, "A").get_by_role("alert")
    expect(trouble).to_have_text("This video has stopped loading.")
    player(page, "A").get_by_role("button", name="Reload this video").click()
    expect(trouble).to_be_hidden()
    play_button(page, "A").click()

    expect(page.locator("#watched")).to_have_text("Still to watch: B")
    # On a busy machine it may stall again.
    wait_until(page, lambda: any(report["stalls"] for report in reports))
    assert sum(report["stalled_seconds"] for report in reports) > 4


def test_a_video_loaded_again_keeps_its_place_and_what_was_watched(
    page: Page, address: str
) -> None:
    begin_study(page, address)
    play_button(page, "A").click()
    expect(page.locator("#watched")).to_have_text("Still to watch: B")

    video = player(page, "A").locator("video")
    video.evaluate("video => { video.currentTime = 0.8; }")
    page.locator(".trouble summary").click()
    page.get_by_role("button", name="Reload A").click()
    expect(video).to_have_attribute("src", re.compile("again=1"))

    expect(video).to_have_js_property("currentTime", 0.3)
    expect(page.locator("#watched")).to_have_text("Still to watch: B")
    page.reload()
    expect(page.locator("#watched")).to_have_text("Still to watch: B")


def test_a_report_whose_answer_is_lost_counts_once_after_a_reload(
    page: Page, address: str, database: Database
) -> None:
    begin_study(page, address)
    arrived: list[str] = []

    def lose_the_answer(route: Route) -> None:
        route.fetch()
        arrived.append(route.request.url.rsplit("/", 1)[1])

    page.route("**/watched/**", lose_the_answer)
    play_button(page, "A").click()
    expect(page.locator("#watched")).to_have_text("Still to watch: B")
    wait_until(page, lambda: arrived)
    page.unroute_all(behavior="ignoreErrors")
    page.reload()

    expect(page.locator("#watched")).to_have_text("Still to watch: B")
    wait_until(page, lambda: played(database, arrived[0]) > 0.9)
    assert played(database, arrived[0]) < 1.05


def test_reports_that_are_to_come_later_are_kept_and_hold_up_nobody_for_long(
    browser: Browser, address: str, database: Database
) -> None:
    page = browser.new_page()  # the browser itself complains of status 429
    page.set_default_timeout(PATIENCE_MS)
    begin_study(page, address)
    refused: list[str] = []

    def refuse(route: Route) -> None:
        refused.append(route.request.url)
        route.fulfill(status=429, headers={"Retry-After": "1"}, body="")

    page.route("**/watched/**", refuse)
    for label in ("A", "B"):
        play_button(page, label).click()
        expect_watched(page, label)
    for group in page.locator("#answers fieldset").all():
        group.locator("label").first.click()
    page.get_by_role("button", name="Next").click()
    wait_until(page, lambda: len(refused) >= 4)
    expect(page.locator("#problem")).to_be_hidden()
    page.unroute("**/watched/**")

    expect_trial(page, 2)
    videos = [video.token for video in study_session_of(page, database).trials[0].videos]
    assert [played(database, video) for video in videos] == pytest.approx([1.0, 1.0], abs=0.1)
    page.close()


def test_the_key_k_plays_the_video_that_has_the_focus(page: Page, address: str) -> None:
    begin_study(page, address)

    with playing_on(*page.locator("video").all()):
        page.keyboard.press("k")
        expect_playing(page, "Video A")
        play_button(page, "B").focus()
        page.keyboard.press("k")
        expect_playing(page, "Video B")
