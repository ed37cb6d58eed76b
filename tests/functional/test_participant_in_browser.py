"""A participant in a real browser, with really playing videos, on the real server.

With ``SCREENSHOTS=folder`` in the environment pages are also taken in every size.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from playwright.sync_api import Page, Route, expect
from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables import Response, StudySession
from tests.functional.browsing import (
    IN_A_BROWSER,
    begin_study,
    expect_trial,
    study_session_of,
    wait_until,
)
from tests.functional.looking import SIZES, photograph
from tests.support.studies.redefining import redefine

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def study(tiny_study_template: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a study with places for all these tests."""
    folder = tmp_path_factory.mktemp("browser") / "study"
    shutil.copytree(tiny_study_template, folder)
    redefine(folder, ("participants_per_comparison = 4", "participants_per_comparison = 50"))
    return folder


def play(page: Page) -> None:
    page.get_by_role("button", name="Play both").click()
    expect(page.locator("#watched")).to_have_text("Watched ✓")


def wait_for_video(page: Page, condition: str) -> None:
    """Wait until `condition` holds of the video."""
    wait_until(page, lambda: page.evaluate(f"document.querySelector('video').{condition}"))


def choose(page: Page, question: str, label: str) -> None:
    page.locator(f"[data-question={question}]").get_by_text(label, exact=True).click()


def answers(page: Page, database: Database) -> list[tuple[int, str, int]]:
    """Return what is stored of the participant whose page this is."""
    ids = {trial.id: trial.position for trial in study_session_of(page, database).trials}
    with database.reading() as session:
        rows = session.scalars(select(Response).order_by(Response.id))
        return [(ids[r.trial_id], r.question, r.value) for r in rows if r.trial_id in ids]


@pytest.mark.parametrize("size", ["laptop", "desktop"])
def test_video_questions_and_next_are_in_view_without_scrolling(
    page: Page, address: str, size: str
) -> None:
    page.set_viewport_size(SIZES[size])
    begin_study(page, address)
    wait_for_video(page, "readyState >= 1")

    for part in ("#pair", "#controls", "#answers", "#next"):
        box = page.locator(part).bounding_box()
        assert box is not None
        assert box["y"] >= 0
        assert box["y"] + box["height"] <= SIZES[size]["height"]
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_a_refresh_keeps_what_was_watched_and_chosen(
    page: Page, address: str, database: Database
) -> None:
    begin_study(page, address)
    play(page)
    choose(page, "emotion", "no difference")

    page.reload()

    expect_trial(page, 1)
    expect(page.locator("#watched")).to_have_text("Watched ✓")
    expect(page.locator("#needed")).to_have_text("Still needed: answer 1")
    expect(page.locator("[name=emotion][value='0']")).to_be_checked()
    assert answers(page, database) == []


def test_the_back_button_is_harmless(page: Page, address: str, database: Database) -> None:
    begin_study(page, address)
    where = page.url
    play(page)
    choose(page, "rhythm", "clearly A")
    choose(page, "emotion", "clearly A")
    page.get_by_role("button", name="Next").click()
    expect_trial(page, 2)

    page.go_back()
    while page.url != f"{address}/" and page.url != "about:blank":
        expect_trial(page, 2)
        page.go_back()
    page.goto(address)
    page.get_by_role("button", name="I agree").click()

    expect_trial(page, 2)
    assert page.url == where
    assert len(answers(page, database)) == 2


def test_a_double_click_on_next_answers_one_trial(
    page: Page, address: str, database: Database
) -> None:
    begin_study(page, address)
    play(page)
    choose(page, "rhythm", "clearly A")
    choose(page, "emotion", "slightly B")

    page.get_by_role("button", name="Next").dblclick()

    expect_trial(page, 2)
    assert answers(page, database) == [(1, "rhythm", -2), (1, "emotion", 1)]
    expect(page.locator(":checked")).to_have_count(0)


def test_a_double_click_on_start_takes_one_place(
    page: Page, address: str, database: Database
) -> None:
    with database.reading() as session:
        before = len(session.scalars(select(StudySession)).all())
    page.goto(address)

    page.get_by_role("button", name="I agree").dblclick()

    expect(page.get_by_role("heading", level=1)).to_have_text("What you will do")
    with database.reading() as session:
        assert len(session.scalars(select(StudySession)).all()) == before + 1


def test_next_says_what_is_missing_and_sends_nothing(
    page: Page, address: str, database: Database
) -> None:
    begin_study(page, address)
    choose(page, "rhythm", "clearly A")

    page.get_by_role("button", name="Next").click()

    expect(page.locator("#needed")).to_have_text("Still needed: play the pair to the end, answer 2")
    expect_trial(page, 1)
    photograph(page, "6-still-needed")
    assert answers(page, database) == []


def test_skipping_to_the_end_does_not_count(page: Page, address: str) -> None:
    begin_study(page, address)
    wait_for_video(page, "readyState >= 1")

    page.evaluate("document.querySelector('video').currentTime = 0.9")
    page.get_by_role("button", name="Play both").click()
    wait_for_video(page, "ended")

    expect(page.locator("#watched")).to_have_text("Still to watch: 1 s")


def test_playing_without_sound_does_not_count_and_says_so(page: Page, address: str) -> None:
    begin_study(page, address)

    page.locator("#volume").fill("0")
    page.get_by_role("button", name="Play both").click()
    wait_for_video(page, "ended")

    expect(page.locator("#watched")).to_have_text("Please turn the sound on")


def test_keys_one_to_five_answer_the_next_question(page: Page, address: str) -> None:
    begin_study(page, address)

    page.keyboard.press("1")
    expect(page.locator("[name=rhythm][value='-2']")).to_be_checked()
    page.keyboard.press("5")
    expect(page.locator("[name=emotion][value='2']")).to_be_checked()

    page.locator("[name=rhythm][value='-2']").focus()
    page.keyboard.press("3")
    expect(page.locator("[name=rhythm][value='0']")).to_be_checked()


def test_everything_can_be_done_from_the_keyboard(page: Page, address: str) -> None:
    begin_study(page, address)

    page.keyboard.press("Tab")
    expect(page.locator("#play")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.locator("#watched")).to_have_text("Watched ✓")
    for _ in range(3):
        page.keyboard.press("Tab")
    page.keyboard.press("Space")
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Tab")
    page.keyboard.press("Space")
    page.keyboard.press("Enter")

    expect_trial(page, 2)


def test_a_lost_connection_loses_no_answer(page: Page, address: str, database: Database) -> None:
    begin_study(page, address)
    play(page)
    choose(page, "rhythm", "clearly A")
    choose(page, "emotion", "clearly A")
    # The next video has come: only the answers are left to be sent.
    expect(page.locator("#ahead")).to_contain_text("next page ready")

    page.context.set_offline(True)
    page.get_by_role("button", name="Next").click()
    expect(page.locator("#problem")).to_contain_text("The connection is lost")
    photograph(page, "7-connection-lost")
    assert answers(page, database) == []
    page.context.set_offline(False)

    expect_trial(page, 2)
    assert len(answers(page, database)) == 2


def test_only_the_next_video_is_fetched_ahead_and_only_after_watching(
    page: Page, address: str
) -> None:
    fetched: list[str] = []
    page.on("request", lambda r: fetched.append(r.url) if "/media/" in r.url else None)
    begin_study(page, address)
    following = address + (page.locator("#pair").get_attribute("data-following") or "")
    wait_for_video(page, "readyState >= 4")
    assert following not in fetched

    play(page)
    expect(page.locator("#ahead")).to_contain_text("next page ready")

    assert len(set(fetched)) == 2
    assert following in fetched


def garbled(route: Route) -> None:
    """Let the server send what is asked for, and the browser get something else."""
    route.fetch()
    route.fulfill(status=200, body="no video")


def test_a_video_that_does_not_play_can_be_left_behind(
    page: Page, address: str, database: Database
) -> None:
    page.route("**/media/**", garbled)
    begin_study(page, address)

    expect(page.get_by_role("alert")).to_have_text("This video cannot be played.")
    page.get_by_role("button", name="This video does not play").click()

    expect_trial(page, 2)
    first, second, *_ = study_session_of(page, database).trials
    assert first.unplayable_at is not None
    assert second.unplayable_at is None
    assert answers(page, database) == []


def test_two_windows_that_do_not_know_of_each_other_do_no_harm(
    page: Page, address: str, database: Database
) -> None:
    page.context.add_init_script("delete window.BroadcastChannel")
    begin_study(page, address)
    second = page.context.new_page()
    second.goto(page.url)
    for window in (page, second):
        window.bring_to_front()
        play(window)
        choose(window, "rhythm", "clearly A")
        choose(window, "emotion", "clearly A")
    page.bring_to_front()
    page.get_by_role("button", name="Next").click()
    expect_trial(page, 2)

    second.bring_to_front()
    choose(second, "rhythm", "clearly B")
    second.get_by_role("button", name="Next").click()

    expect_trial(second, 2)
    assert answers(page, database) == [(1, "rhythm", -2), (1, "emotion", -2)]


def test_a_browser_that_forbids_storage_can_take_part(
    page: Page, address: str, database: Database
) -> None:
    page.add_init_script(
        "Object.defineProperty(window, 'sessionStorage',"
        " { get() { throw new DOMException('forbidden', 'SecurityError'); } })"
    )
    begin_study(page, address)
    play(page)
    choose(page, "rhythm", "clearly A")
    choose(page, "emotion", "clearly A")

    page.get_by_role("button", name="Next").click()

    expect_trial(page, 2)
    assert len(answers(page, database)) == 2
