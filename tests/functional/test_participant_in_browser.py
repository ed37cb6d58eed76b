"""A participant in a real browser on the real server: what counts as watched, and what is kept."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, Request, Response, Route, expect
from sqlalchemy import func, select

from studyapp.database.engine import Database
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Video, WatchRecord
from tests.functional.browsing import IMPATIENT, IN_A_BROWSER, PATIENCE_MS, follow, wait_until
from tests.functional.taking_part import (
    WATCHED,
    answer,
    answers_of,
    begin_study,
    expect_playing,
    expect_trial,
    playing_on,
    study_session_of,
    watch,
)
from tests.support.studies.finished_study import question, write_finished_study, write_short_video

pytestmark = IN_A_BROWSER

FORCED_RATE = """() => {
  const rate = Object.getOwnPropertyDescriptor(HTMLMediaElement.prototype, "playbackRate");
  const video = document.querySelector("video");
  rate.set.call(video, 4);
  Object.defineProperty(video, "playbackRate", { get() { return 4; }, set() {} });
}"""
"""A browser extension that makes videos faster, and does not let the page change it."""

PRETENDED_HIDDEN = """() => {
  Object.defineProperty(document, "hidden", { get: () => true });
  document.dispatchEvent(new Event("visibilitychange"));
}"""
SILENCED = """() => {
  const volume = document.querySelector("#volume");
  volume.value = 0;
  volume.dispatchEvent(new Event("input", { bubbles: true }));
}"""
SKIPPED = "() => { document.querySelector('video').currentTime = 0.9; }"

RELOADED_MEANWHILE = """video => video.addEventListener("timeupdate", () => {
  if (video.currentTime > 0.1) location.reload();
})"""
"""Somebody who reloads the page while a video plays, surely before its end."""

BUSY_AS_IT_BEGINS = """button => {
  const end = performance.now() + 500;
  button.click();
  while (performance.now() < end);
}"""

B_IS_LEFT = "Still to watch: B"


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a study of two players and two questions a trial, with places for all these tests."""
    folder = tmp_path_factory.mktemp("participant") / "study"
    folder.mkdir()
    video = folder.parent / "short.mp4"
    write_short_video(video, seconds=1.0)
    asked = [question("rhythm", "Which fits better?"), question("emotion", "Which shows more?")]
    write_finished_study(folder, "pairwise", video, participants=30, questions=asked)
    return folder


def player(page: Page, label: str) -> Locator:
    return page.get_by_role("region", name=f"Video {label}")


def play_button(page: Page, label: str) -> Locator:
    return page.get_by_role("button", name=f"Play {label}", exact=True)


def choose(page: Page, name: str, value: int) -> None:
    page.locator(f"label:has([name={name}][value='{value}'])").click()


def expect_missing(page: Page, words: str | re.Pattern[str]) -> None:
    """Wait until the page shows this text about what is still to be watched."""
    expect(page.locator("#watched")).to_have_text(words)


def reports_of(page: Page) -> list[dict[str, Any]]:
    """Return a list that collects the page's watch reports."""
    reports: list[dict[str, Any]] = []

    def look_at(request: Request) -> None:
        if "/watched/" in request.url:
            reports.append(json.loads(request.post_data or ""))

    page.on("request", look_at)
    return reports


def watch_record(database: Database, video_token: str) -> WatchRecord:
    query = select(WatchRecord).join(WatchRecord.video).where(Video.token == video_token)
    with database.reading() as session:
        return session.scalars(query).one()


def garble(route: Route) -> None:
    """Let the server answer, but give the browser another response."""
    route.fetch()
    route.fulfill(status=200, content_type="video/mp4", body="no video")


def test_incomplete_answers_are_not_sent_and_a_refresh_keeps_progress(
    page: Page, address: str, database: Database
) -> None:
    begin_study(page, address)
    page.locator("#next").click()
    expect(page.locator("#needed")).to_have_text("Still needed: watch A and B, answer 1 and 2")
    watch(page)
    choose(page, "emotion", 0)

    page.reload()

    expect_trial(page, 1)
    expect_missing(page, WATCHED)
    expect(page.locator("#needed")).to_have_text("Still needed: answer 1")
    expect(page.locator("[name=emotion][value='0']")).to_be_checked()
    assert answers_of(page, database) == []


def test_double_clicks_and_going_back_are_harmless(
    page: Page, address: str, database: Database
) -> None:
    def count_sessions() -> int:
        with database.reading() as session:
            return session.scalars(select(func.count()).select_from(StudySession)).one()

    before = count_sessions()
    page.goto(address)
    page.get_by_role("button", name="I agree").dblclick()
    expect(page.get_by_role("heading", level=1)).to_have_text("What you will do")
    assert count_sessions() == before + 1
    page.get_by_role("button", name="Begin").click()
    where = page.url
    watch(page)
    choose(page, "rhythm", -2)
    choose(page, "emotion", 1)

    page.locator("#next").dblclick()

    expect_trial(page, 2)
    expect(page.locator(":checked")).to_have_count(0)
    page.go_back()
    while page.url not in (f"{address}/", "about:blank"):
        expect_trial(page, 2)
        page.go_back()
    page.goto(address)
    page.get_by_role("button", name="I agree").click()
    expect_trial(page, 2)
    assert page.url == where
    assert answers_of(page, database) == [(1, "emotion", 1), (1, "rhythm", -2)]


@pytest.mark.parametrize(
    ("way", "words"),
    [
        (SKIPPED, "Still to watch: A 1 s · B"),
        (SILENCED, "Please turn the sound on"),
        (FORCED_RATE, "Please let the video play at normal speed"),
        (PRETENDED_HIDDEN, "Please keep the video in view while it plays"),
    ],
    ids=("in part", "silently", "faster", "out of view"),
)
def test_partial_silent_fast_or_hidden_playback_does_not_count_and_says_so(
    page: Page, address: str, way: str, words: str
) -> None:
    begin_study(page, address)
    reports = reports_of(page)
    expect(page.locator("video").first).to_have_js_property("readyState", 4)
    page.evaluate(way)

    def tells_of_playing(response: Response) -> bool:
        return "/watched/" in response.url and any(report["intervals"] for report in reports)

    with page.expect_response(tells_of_playing) as answered:
        play_button(page, "A").click()

    expect_missing(page, words)
    expect(page.locator("#needed")).to_contain_text("Still needed: watch A and B")
    assert answered.value.json()["missing"] > 0.5


def test_keys_play_the_focused_video_and_answer_the_next_question(page: Page, address: str) -> None:
    begin_study(page, address)
    with playing_on(*page.locator("video").all()):
        page.keyboard.press("k")
        expect_playing(page, "Video A")
        play_button(page, "B").focus()
        page.keyboard.press("k")
        expect_playing(page, "Video B")

    for key, name, value in (("1", "rhythm", -2), ("5", "emotion", 2)):
        page.keyboard.press(key)
        expect(page.locator(f"[name={name}][value='{value}']")).to_be_checked()
    page.locator("[name=rhythm][value='-2']").press("3")
    expect(page.locator("[name=rhythm][value='0']")).to_be_checked()


def test_playback_on_a_busy_page_counts_with_its_frames(
    page: Page, address: str, database: Database
) -> None:
    begin_study(page, address)
    expect(player(page, "A").locator("video")).to_have_js_property("readyState", 4)

    with page.expect_response(
        lambda response: "/watched/" in response.url and response.json()["missing"] == 0
    ) as answered:
        play_button(page, "A").evaluate(BUSY_AS_IT_BEGINS)

    expect_missing(page, B_IS_LEFT)
    record = watch_record(database, answered.value.url.rsplit("/", 1)[1])
    assert (record.rate, record.hidden_seconds + record.silent_seconds) == (1, 0)
    assert record.frames
    assert record.dropped_frames is not None


def test_a_refresh_during_playback_keeps_what_was_played(page: Page, address: str) -> None:
    begin_study(page, address)
    player(page, "A").locator("video").evaluate(RELOADED_MEANWHILE)
    follow(play_button(page, "A"))

    # Without the played part, A would be as unwatched as B, and no seconds would be shown. While
    # the page is asked for, the video may come to its end.
    expect_missing(page, re.compile(r"^Still to watch: (A 1 s · )?B$"))


def test_a_broken_video_can_be_reported_and_the_trial_skipped(
    page: Page, address: str, database: Database
) -> None:
    page.goto(address)
    follow(page.get_by_role("button", name="I agree"))
    broken = study_session_of(page, database).trials[0].videos[1].token
    page.route(f"**/media/{broken}.mp4*", garble)
    page.get_by_role("button", name="Begin").click()

    trouble = player(page, "B").get_by_role("alert")
    expect(trouble).to_have_text("This video cannot be played.")
    expect(player(page, "A").get_by_role("alert")).to_be_hidden()
    player(page, "B").get_by_role("button", name="This video does not play").press("Enter")

    expect_trial(page, 2)
    first, second, *_ = study_session_of(page, database).trials
    assert first.unplayable_at is not None
    assert second.unplayable_at is None
    assert [v.token for v in first.videos if v.unplayable_at is not None] == [broken]
    assert answers_of(page, database) == []


def test_a_broken_or_stalled_video_can_be_reloaded_in_place(
    page: Page, address: str, database: Database
) -> None:
    # A video that is loaded again has another address.
    page.goto(address)
    follow(page.get_by_role("button", name="I agree"))
    broken, stalled = (video.token for video in study_session_of(page, database).trials[0].videos)
    unanswered: list[Route] = []
    page.route(f"**/media/{broken}.mp4", garble)
    page.route(f"**/media/{stalled}.mp4", lambda route: unanswered.append(route))
    page.get_by_role("button", name="Begin").click()
    reports = reports_of(page)

    expect(player(page, "A").get_by_role("alert")).to_be_visible()
    player(page, "A").get_by_role("button", name="Reload this video").click()
    expect(player(page, "A").get_by_role("alert")).to_be_hidden()
    expect(play_button(page, "A")).to_be_focused()
    page.keyboard.press("Enter")
    expect_missing(page, B_IS_LEFT)
    play_button(page, "B").click()
    trouble = player(page, "B").get_by_role("alert")
    expect(trouble).to_have_text("This video has stopped loading.")
    player(page, "B").get_by_role("button", name="Reload this video").click()
    expect(trouble).to_be_hidden()
    play_button(page, "B").click()
    expect_missing(page, WATCHED)
    # On a busy machine it may stall again.
    wait_until(page, lambda: any(report["stalls"] for report in reports))
    assert sum(report["stalled_seconds"] for report in reports) > 4

    page.unroute_all(behavior="ignoreErrors")
    page.reload()
    expect_missing(page, WATCHED)


def test_delayed_blocked_and_repeated_reports_count_once_and_block_nobody_for_long(
    browser: Browser, address: str, database: Database
) -> None:
    page = browser.new_page()  # the browser itself complains of status 429
    page.set_default_timeout(PATIENCE_MS)
    page.add_init_script(IMPATIENT)
    begin_study(page, address)
    refused: list[str] = []
    unanswered: list[Route] = []

    def refuse(route: Route) -> None:
        refused.append(route.request.url)
        route.fulfill(status=429, headers={"Retry-After": "1"}, body="")

    def lose_the_answer(route: Route) -> None:
        route.fetch()
        unanswered.append(route)

    page.route("**/watched/**", refuse)
    watch(page)
    answer(page)
    page.locator("#next").click()
    wait_until(page, lambda: len(refused) >= 4)
    problem = page.locator("#problem")
    expect(problem).to_be_hidden()
    page.route("**/watched/**", lambda route: route.abort("blockedbyclient"))
    expect(problem).to_contain_text("If this lasts, please switch ad blockers off")
    page.unroute("**/watched/**")
    page.route("**/watched/**", lose_the_answer, times=2)

    expect_trial(page, 2)
    assert len(unanswered) == 2
    videos = [video.token for video in study_session_of(page, database).trials[0].videos]
    played = [watch_record(database, video).played_seconds for video in videos]
    assert played == pytest.approx([1.0, 1.0], abs=0.1)
    page.close()
