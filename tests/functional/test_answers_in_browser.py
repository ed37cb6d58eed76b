"""Videos put in order by clicks, dragging, keys and menus, and sliders without a preset."""

from collections.abc import Iterator
from contextlib import ExitStack

import pytest
from flask import Flask
from playwright.sync_api import Browser, Locator, Page, expect

from studyapp.web.language import language_of, speak
from studyapp.web.site import site_of
from tests.functional.browsing import IN_A_BROWSER, wait_until, watched_page
from tests.functional.page_checks import video_sizes
from tests.functional.shown_studies import write_shown_study
from tests.functional.taking_part import answer, first_trial, shown
from tests.studyapp.web.brackets import bracketed, left_in_english
from tests.studyapp.web.page_reader import PageReader

pytestmark = IN_A_BROWSER


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, tuple[str, Flask]]]:
    """Serve a study of sliders, one without ties, of five videos, and one with ties, of four."""
    folder = tmp_path_factory.mktemp("studies")
    with ExitStack() as stack:
        studies = {}
        for name in ("sliders", "ranking", "ties"):
            write_shown_study(folder / name, name)
            studies[name] = stack.enter_context(shown(folder / name))
        yield studies


@pytest.fixture
def page(
    browser: Browser, served: dict[str, tuple[str, Flask]], request: pytest.FixtureRequest
) -> Iterator[Page]:
    """Return the first trial of the study that the test names; of `ranking` if none."""
    address, app = served[getattr(request, "param", "ranking")]
    with watched_page(browser, address) as opened:
        first_trial(opened, address, app)
        expect(opened.locator(".card, .slider [type=range]").first).to_be_visible()
        yield opened


def question(page: Page) -> Locator:
    return page.locator(".question").first


def card(page: Page, label: str) -> Locator:
    return question(page).locator(".card", has_text=label)


def rank_in_order(page: Page, labels: str) -> None:
    for label in labels:
        card(page, label).click()


def drag(page: Page, label: str, target: Locator) -> None:
    card(page, label).hover()
    page.mouse.down()
    box = target.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] - 8, box["y"] + box["height"] / 2, steps=4)
    page.mouse.up()


def expect_order(page: Page, order: str) -> None:
    expect(question(page).locator(".order")).to_have_text(f"Your order: {order}" if order else "")


def chosen(page: Page) -> str:
    """Return the ranks of A, B, … as the form would send them."""
    menus = question(page).locator("select").all()
    return "".join(menu.input_value() or "-" for menu in menus)


def test_clicks_rank_from_best_to_worst_and_survive_a_reload(page: Page) -> None:
    expect(question(page).locator(".tray .card")).to_have_text(["A", "B", "C", "D", "E"])
    expect_order(page, "")
    assert chosen(page) == "-----"
    rank_in_order(page, "CAEDB")
    expect_order(page, "1st C, 2nd A, 3rd E, 4th D and 5th B")
    assert chosen(page) == "25143"

    page.reload()

    expect_order(page, "1st C, 2nd A, 3rd E, 4th D and 5th B")
    expect(page.locator("#needed")).to_contain_text("answer 2, 3 and 4")
    page.get_by_role("button", name="Next").click()
    expect(page.locator(".question").nth(1).locator(".tray .card").first).to_be_focused()
    card(page, "A").click()
    expect(question(page).locator(".tray .card")).to_have_text(["A"])
    assert chosen(page) == "-5143"


def test_a_dragged_card_lands_where_it_is_dropped_and_moves_others_only_as_needed(
    page: Page,
) -> None:
    places = question(page).locator(".place")
    drag(page, "B", places.nth(2))
    expect_order(page, "3rd B")
    rank_in_order(page, "ACDE")
    expect_order(page, "1st A, 2nd C, 3rd B, 4th D and 5th E")

    drag(page, "E", places.first)
    expect_order(page, "1st E, 2nd A, 3rd C, 4th B and 5th D")

    drag(page, "C", question(page).locator(".waiting"))
    expect_order(page, "1st E, 2nd A, 4th B and 5th D")
    drag(page, "A", page.locator("header"))
    expect_order(page, "1st E, 2nd A, 4th B and 5th D")


def test_keys_move_the_focused_card(page: Page) -> None:
    announcement = page.locator(".questions [role=status]")
    card(page, "D").focus()
    for key, words in (
        ("ArrowRight", "1st of 5: D"),
        ("ArrowRight", "2nd of 5: D"),
        ("End", "5th of 5: D"),
        ("ArrowLeft", "4th of 5: D"),
        ("Home", "1st of 5: D"),
        ("3", "3rd of 5: D"),
        ("Delete", "D: no place yet"),
        ("Enter", "1st of 5: D"),
    ):
        page.keyboard.press(key)
        expect(announcement).to_have_text(words)
        expect(card(page, "D")).to_be_focused()
    expect(card(page, "D")).to_have_accessible_name("1st of 5: D")
    page.keyboard.press("Tab")
    expect(card(page, "A")).to_be_focused()


def test_menus_can_be_used_instead_and_show_errors(page: Page) -> None:
    page.get_by_role("button", name="Use menus instead").click()
    expect(page.locator(".card:visible")).to_have_count(0)
    menus = question(page).locator("select").all()
    for menu, rank in zip(menus, "12344", strict=True):
        menu.select_option(rank)
    expect(question(page).locator(".order")).to_have_text(
        "Two videos have the same rank: each needs its own."
    )
    expect(page.locator("#needed")).to_contain_text("4 answers")

    menus[4].select_option("5")

    expect_order(page, "1st A, 2nd B, 3rd C, 4th D and 5th E")
    expect(page.locator("#needed")).to_contain_text("answer 2, 3 and 4")
    page.reload()
    expect(question(page).locator("select").first).to_be_visible()
    page.get_by_role("button", name="Use letters instead").click()
    expect(question(page).locator(".card").first).to_be_visible()
    expect(page.get_by_role("button", name="Use menus instead")).to_be_visible()


@pytest.mark.parametrize("page", ["ties"], indirect=True)
def test_ranks_are_shared_only_if_the_study_allows_ties(page: Page) -> None:
    places = question(page).locator(".place")
    rank_in_order(page, "ABCD")
    drag(page, "B", places.first)
    expect(question(page).locator(".order")).to_have_text(
        "No video is 2nd: please leave no rank out."
    )
    drag(page, "C", places.nth(1))
    drag(page, "D", places.nth(2))
    expect_order(page, "1st A = B, 2nd C and 3rd D")
    assert chosen(page) == "1123"


def test_all_videos_stay_in_view_and_enlarging_them_is_not_sent(page: Page) -> None:
    sent = "[...new FormData(document.querySelector('#answers'))].flat().join()"
    (small,), before = video_sizes(page), page.evaluate(sent)
    page.locator(".question").last.scroll_into_view_if_needed()
    for video in page.locator("video").all():
        expect(video).to_be_in_viewport(ratio=0.95)
    for part in (page.locator("#next"), page.locator(".question").last.locator(".place").first):
        expect(part).to_be_in_viewport(ratio=1)

    page.get_by_role("button", name="Larger videos").click()

    ((width, height),) = video_sizes(page)
    assert min(width, height) > 2 * max(small)
    page.get_by_role("button", name="Play E", exact=True).click()
    expect(page.locator("video").last).to_be_in_viewport(ratio=0.95)
    expect(page.locator(".place").first).to_be_in_viewport(ratio=1)
    assert page.evaluate(sent) == before
    page.reload()
    expect(page.get_by_role("button", name="Smaller videos")).to_be_visible()
    page.keyboard.press("l")
    expect(page.get_by_role("button", name="Larger videos")).to_be_visible()
    assert video_sizes(page) == {small}


def line(page: Page, number: int = 0) -> Locator:
    return page.locator(".slider [type=range]").nth(number)


def field(page: Page, number: int = 0) -> Locator:
    return page.locator(".slider [type=number]").nth(number)


@pytest.mark.parametrize("page", ["sliders"], indirect=True)
def test_a_slider_is_empty_keeps_its_value_and_starts_in_the_middle_or_at_an_end(
    page: Page,
) -> None:
    expect(line(page)).to_have_attribute("aria-valuetext", "nothing chosen yet")
    expect(page.locator(".bands .chosen")).to_have_count(0)
    line(page).focus()
    page.keyboard.press("Tab")
    expect(field(page)).to_have_value("")
    field(page).fill("85")
    field(page).press("Tab")
    expect(page.locator(".bands .chosen")).to_have_text("excellent")

    page.reload()

    expect(field(page)).to_have_value("85")
    expect(line(page)).to_have_value("85")
    expect(line(page)).to_have_attribute("aria-valuetext", "85, excellent")

    # The first key starts in the middle or at an end.
    keys = {
        "ArrowLeft": ("50", "49"),
        "ArrowUp": ("50", "51"),
        "PageDown": ("50", "40"),
        "Home": ("0", "0"),
        "End": ("100", "100"),
    }
    for number, (key, values) in enumerate(keys.items(), start=1):
        for value in values:
            line(page, number).press(key)
            expect(field(page, number)).to_have_value(value)

    # Beside each other on a tablet, words keep the whole width under their video.
    page.set_viewport_size({"width": 768, "height": 1024})
    whole = "bands => bands.offsetWidth === bands.parentElement.offsetWidth"
    wait_until(page, lambda: page.locator(".bands").first.evaluate(whole))


def test_a_click_or_touch_selects_its_position(
    browser: Browser, served: dict[str, tuple[str, Flask]]
) -> None:
    touched = browser.new_context(has_touch=True).new_page()
    first_trial(touched, *served["sliders"])
    box = line(touched).bounding_box()
    assert box is not None
    line(touched).click(position={"x": box["width"] * 0.25, "y": box["height"] / 2})
    assert 23 <= int(field(touched).input_value()) <= 27
    line(touched).tap(position={"x": box["width"] * 0.8, "y": box["height"] / 2})
    assert 78 <= int(field(touched).input_value()) <= 82
    touched.context.close()


@pytest.mark.parametrize("page", ["sliders", "ties"], indirect=True)
def test_every_text_of_the_scripts_is_translated(
    page: Page, served: dict[str, tuple[str, Flask]]
) -> None:
    (app,) = (app for address, app in served.values() if page.url.startswith(address))

    def english() -> str:
        return left_in_english(PageReader(page.content()), site_of(app).study)

    speak(app, bracketed())
    page.reload()
    page.locator("#next").click()
    expect(page.locator("#needed")).to_have_class("asked")
    assert english() == ""
    for button in page.locator(".play").all():
        button.click()
        assert english() == ""
    answer(page)
    assert english() == ""
    speak(app, language_of("en"))
