"""Every protocol with players of its own, from consent to completion code, in a real browser."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect
from sqlalchemy import select

from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables import Response
from tests.functional.browsing import (
    IN_A_BROWSER,
    begin_study,
    expect_playing,
    expect_watched,
    playing_on,
    still_asked,
    watched_page,
)
from tests.functional.every_page import shown
from tests.functional.looking import expect_videos, photograph
from tests.support.studies.finished_study import write_finished_study, write_short_video
from tests.support.studies.redefining import redefine

pytestmark = IN_A_BROWSER

CHANGES = {
    "pairwise": [("trials = 3\npractice = 1", "trials = 1\npractice = 0")],
    "rating": [('scale = "slider"', 'scale = "mean_opinion"')],
}
"""Less to watch, and nothing but answers that are chosen."""

MOST_TIMES = 5
AWAIT_END = """video => {
    window.ended = new Promise(end => video.addEventListener("ended", end, {once: true}))
        .then(() => true);
}"""


@pytest.fixture(scope="module")
def video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("video") / "short.mp4"
    write_short_video(path, seconds=0.5)
    return path


@pytest.fixture
def study(tmp_path: Path, video: Path, request: pytest.FixtureRequest) -> Path:
    """Return a study of the protocol that the test names."""
    folder: Path = tmp_path / request.param
    folder.mkdir()
    write_finished_study(folder, request.param, video)
    redefine(folder, *CHANGES.get(request.param, ()))
    return folder


@pytest.fixture
def page(browser: Browser, study: Path) -> Iterator[Page]:
    """Return a page at the first trial."""
    with shown(study) as (address, _), watched_page(browser, address) as opened:
        begin_study(opened, address)
        yield opened


def labels(page: Page) -> list[str]:
    return [str(video.get_attribute("data-label")) for video in page.locator("video").all()]


def watch_all(page: Page, button: str = ".play") -> None:
    """Play one video after the other, and see that no two ever play at once.

    Where the machine was too busy to show a piece, the page says so, and it is played once more.
    """
    for number, label in enumerate(labels(page)):
        player = page.locator(".player").nth(number)
        for _time in range(MOST_TIMES):
            player.locator("video").evaluate(AWAIT_END)
            player.locator(button).click()
            page.evaluate("window.ended")
            if not still_asked(page, label):
                break
        expect_watched(page, label)
        assert page.locator(".playing").count() <= 1


def answer_all(page: Page) -> None:
    for question in page.locator(".question").all():
        cards = question.locator(".card").count()
        for _card in range(cards):
            question.locator(".tray .card").first.click()
        if not cards:
            question.locator(".scale label").first.click()


def take_trial(page: Page) -> None:
    watch_all(page)
    answer_all(page)
    expect(page.locator("#needed")).to_have_text("All done – press Next")
    page.get_by_role("button", name="Next").click()


@pytest.mark.parametrize(
    ("study", "trials", "answers"),
    [("pairwise", 3, 3), ("rating", 3, 18), ("ranking", 2, 4), ("mismatch", 4, 4)],
    indirect=["study"],
)
def test_a_study_session_from_consent_to_code(
    page: Page, study: Path, trials: int, answers: int
) -> None:
    for number in range(1, trials + 1):
        expect(page.locator(".progress")).to_contain_text(f"Trial {number} of {trials}")
        if number == 1:
            photograph(page, f"{study.name}-trial")
        take_trial(page)

    expect(page.get_by_role("heading", level=1)).to_contain_text("Thank you")
    assert page.locator("#completion-code").inner_text()
    database = Database.open(sqlite_url(study / "responses.db"))
    with database.reading() as session:
        assert len(session.scalars(select(Response)).all()) == answers
    database.close()


@pytest.mark.parametrize("study", ["rating"], indirect=True)
def test_several_players_on_a_page(page: Page, study: Path) -> None:
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

    # They are as large and as loud as each other.
    page.locator("#volume").fill("0.5")
    expect_videos(page)
    boxes = [player.bounding_box() for player in (a, b, c)]
    assert len({(box["width"], box["height"], box["y"]) for box in boxes if box}) == 1
    assert {video.evaluate("video => video.volume") for video in (a, b, c)} == {0.5}

    # What is missing is said, and stays in view with Next.
    page.get_by_role("button", name="Next").click()
    expect(page.locator("#needed")).to_contain_text("6 answers")
    for part in ("#needed", "#watched", "#next"):
        expect(page.locator(part)).to_be_in_viewport(ratio=1)

    # The next trial's videos come when these were watched, one after the other.
    assert not [url for url in fetched if any(url.endswith(path) for path in following)]
    watch_all(page, ".replay")
    expect(page.locator("#ahead")).to_contain_text("next page ready")
    ahead = [url for url in fetched if any(url.endswith(path) for path in following)]
    assert [url.rsplit("/", 1)[1] for url in ahead] == [p.rsplit("/", 1)[1] for p in following]
