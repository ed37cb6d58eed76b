"""Protocols with separate players, from consent to completion code, in a real browser."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from studyapp.database.engine import Database
from studyapp.web.site import site_of
from tests.functional.browsing import IN_A_BROWSER, watched_page
from tests.functional.page_checks import video_sizes
from tests.functional.taking_part import (
    answers_of,
    begin_study,
    expect_playing,
    playing_on,
    shown,
    study_session_of,
    take_trial,
    watch,
)
from tests.support.studies.finished_study import (
    Keys,
    group,
    write_finished_study,
    write_short_video,
)

pytestmark = IN_A_BROWSER

Served = tuple[str, Database]
"""Address of a study, and its database."""


FEWER_TRIALS: dict[str, Keys] = {
    "rating": {"attention": None},
    "ranking": {"blocks": [group("all", "ours", "theirs", trials=1)]},
    "mismatch": {"fit": 1, "realism": 1, "attention": None},
}


@pytest.fixture
def served(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Served]:
    """Serve a study of the protocol that the test names, with not much to watch."""
    video = tmp_path / "short.mp4"
    write_short_video(video, seconds=0.5)
    write_finished_study(tmp_path, request.param, video, **FEWER_TRIALS[request.param])
    with shown(tmp_path) as (address, app):
        yield address, site_of(app).database


@pytest.fixture
def page(browser: Browser, served: Served) -> Iterator[Page]:
    """Return a page at the first trial."""
    address, _ = served
    with watched_page(browser, address) as opened:
        begin_study(opened, address)
        yield opened


def expect_code(page: Page, database: Database, *, answers: int) -> None:
    """Wait for the code of a participant who has given so many answers."""
    expect(page.get_by_role("heading", level=1)).to_contain_text("Thank you")
    code = page.locator("#completion-code").inner_text()
    assert code == study_session_of(page, database).completion_code
    assert len(answers_of(page, database)) == answers


@pytest.mark.parametrize(
    ("served", "trials", "answers"), [("ranking", 1, 2), ("mismatch", 2, 2)], indirect=["served"]
)
def test_a_study_session_from_consent_to_code(
    page: Page, served: Served, trials: int, answers: int
) -> None:
    for number in range(1, trials + 1):
        take_trial(page, number)

    expect_code(page, served[1], answers=answers)


@pytest.mark.parametrize("served", ["rating"], indirect=True)
def test_several_players_on_a_page_up_to_the_code(page: Page, served: Served) -> None:
    fetched: list[str] = []
    page.on("request", lambda r: fetched.append(r.url) if "/media/" in r.url else None)
    following = str(page.locator("[data-following]").get_attribute("data-following")).split()
    a, b, c = (page.get_by_label(f"Video {label}").locator("video") for label in "ABC")

    # Starting one pauses the others, and outlines it.
    with playing_on(a, b):
        a.click()
        expect_playing(page, "Video A")
        b.click()
        expect_playing(page, "Video B")
        assert a.evaluate("video => video.paused")

    # They are as large and as loud as each other, and on one line.
    page.locator("#volume").fill("0.5")
    assert len(video_sizes(page)) == 1
    assert len({video.evaluate("video => video.offsetTop") for video in (a, b, c)}) == 1
    assert {video.evaluate("video => video.volume") for video in (a, b, c)} == {0.5}

    # What is missing is said, and stays in view with Next.
    page.get_by_role("button", name="Next").click()
    expect(page.locator("#needed")).to_contain_text("6 answers")
    for part in ("#needed", "#watched", "#next"):
        expect(page.locator(part)).to_be_in_viewport(ratio=1)

    # The next trial's videos come when these were watched, one after the other.
    assert not [url for url in fetched if any(url.endswith(path) for path in following)]
    watch(page)
    expect(page.locator("#ahead")).to_contain_text("next page ready")
    ahead = [url for url in fetched if any(url.endswith(path) for path in following)]
    assert [url.rsplit("/", 1)[1] for url in ahead] == [p.rsplit("/", 1)[1] for p in following]

    for number in (1, 2):
        take_trial(page, number)
    expect_code(page, served[1], answers=12)
