"""Trials of several players over HTTP: what their pages show, and that their forms work."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from bs4 import Tag
from sqlalchemy import select

from motion.segment import EMOTIONS
from studyapp.database.tables import Response, Trial, Video
from studyapp.web.participants.trial_page import EMOTION_WORDS
from tests.studyapp.conftest import OwnStudy
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import Visitor, filled, stored_in
from tests.support.studies.taking_part_steps import SetClock

Arrive = Callable[..., Visitor]


@pytest.fixture
def arrive(own_study: OwnStudy, serve: Serve, clock: SetClock) -> Arrive:
    """Return a function that brings a participant to the first trial of a protocol's study."""

    def make(protocol: str, scale: str = "mean_opinion") -> Visitor:
        scales = [('scale = "slider"', f'scale = "{scale}"')] if protocol == "rating" else []
        app = serve(*scales, folder=own_study(protocol).root)
        return Visitor(app, clock).enrol().begin()

    return make


def count_responses(visitor: Visitor) -> int:
    return len(stored_in(visitor.app, select(Response)))


def trials(visitor: Visitor) -> list[Trial]:
    return list(stored_in(visitor.app, select(Trial).order_by(Trial.position)))


def submit(visitor: Visitor, page: PageReader, answers: dict[str, str]) -> tuple[int, PageReader]:
    sent = visitor.client.post(page.action, data={"trial": page.trial, **answers})
    return sent.status_code, PageReader(sent.text)


def words(tag: Tag) -> str:
    return " ".join(tag.get_text().split())


def test_every_emotion_has_words() -> None:
    assert [str(word) for word in EMOTION_WORDS.values()] == list(EMOTIONS) == list(EMOTION_WORDS)


def test_players_are_labelled_in_order_and_under_each_stand_its_questions(arrive: Arrive) -> None:
    page = arrive("rating").page()

    assert [video["data-label"] for video in page.soup.select("video")] == ["A", "B", "C"]
    for number, (player, label) in enumerate(
        zip(page.soup.select(".player"), "ABC", strict=True), 1
    ):
        shown = (player["aria-label"], words(player.select(".label")[0]))
        assert shown == (f"Video {label}", label)
        buttons = [words(button) for button in player.select(".controls button")]
        assert buttons == [f"▶ Play {label}", "↺ Replay"]
        fields = {str(radio["name"]) for radio in player.select("[type=radio]")}
        assert fields == {f"quality:{number}", f"synchrony:{number}"}
        for question in player.select(".question"):
            labels = [words(label) for label in question.select(".scale label")]
            assert labels == ["bad", "poor", "fair", "good", "excellent"]
            assert [radio["value"] for radio in question.select("[type=radio]")] == list("12345")
    assert page.checked() == {}


@pytest.mark.parametrize("protocol", ["pairwise", "rating", "ranking", "mismatch"])
def test_of_several_videos_the_one_that_does_not_play_is_named(
    arrive: Arrive, protocol: str
) -> None:
    visitor = arrive(protocol)
    page = visitor.page()
    action = str(page.one("form#unplayable")["action"])

    assert visitor.client.post(action, data={"trial": page.trial}).status_code == 422
    for video in page.soup.select("video"):
        faults = page.soup.select(f"#{video['id']}-fault [form=unplayable]")
        buttons = page.soup.select(
            f".trouble li:has([data-reloads={video['id']}]) [form=unplayable]"
        )
        assert [b["value"] for b in faults] == [b["value"] for b in buttons]
    token = str(faults[0]["value"])
    visitor.client.get(str(video["src"]), buffered=True)
    data = {"trial": page.trial, "video": token, "error": "4"}
    answer = visitor.client.post(action, data=data)

    assert answer.status_code == 303
    assert trials(visitor)[0].unplayable_at is not None
    named = stored_in(visitor.app, select(Video.token).where(Video.unplayable_at.is_not(None)))
    assert named == [token]
    assert count_responses(visitor) == 0


def test_each_part_is_announced_once_and_its_sound_too(arrive: Arrive) -> None:
    visitor = arrive("mismatch")

    seen = list(visitor.take_trials())

    parts = [trial.part for trial in trials(visitor)]
    muted = [part == "realism" for part in parts]
    new = [i == 0 or parts[i] != parts[i - 1] for i in range(len(parts))]
    assert [bool(page.soup.select(".part")) for page in seen] == new
    assert [len(page.soup.select("video[muted][data-soundless]")) == 2 for page in seen] == muted
    assert [not page.soup.select("#volume") for page in seen] == muted


def test_attention_checks_look_like_every_page_and_say_what_to_answer(arrive: Arrive) -> None:
    visitor = arrive("rating")

    seen = list(visitor.take_trials())

    labels = ("bad", "poor", "fair", "good", "excellent")
    checks = [trial.instructed for trial in trials(visitor)]
    assert sum(instructed is not None for instructed in checks) == 1
    for page, instructed in zip(seen, checks, strict=True):
        legends = [words(legend) for legend in page.soup.select("legend")]
        asked = "" if instructed is None else f"this one with {labels[instructed - 1]}."
        assert [asked != "" and asked in text for text in legends] == [asked != ""] * 6
        # Only the first question explains why.
        assert sum("please answer this one" in text for text in legends) == (asked != "")


def test_a_ranking_shows_its_reference_apart_and_asks_for_a_rank_of_each(arrive: Arrive) -> None:
    page = arrive("ranking").page()

    assert [video["data-label"] for video in page.soup.select("video")] == ["Reference", "A", "B"]
    assert page.words(".apart .label") == "Reference"
    assert page.words(".aside") == "The reference is for comparison; it is not ranked."
    ranks = page.soup.select("#answers select")
    for rank, (name, letter) in zip(ranks, (("realism:1", "A"), ("realism:2", "B")), strict=True):
        label = f"Question 1: rank of video {letter}"
        assert (rank["name"], rank["aria-label"]) == (name, label)
        options = {str(option["value"]): words(option) for option in rank.select("option")}
        assert options == {"": "choose …", "1": "1st – best", "2": "2nd – last"}
    assert page.soup.select("[selected]") == []


@pytest.mark.parametrize(
    ("answers", "problem"),
    [
        ({"realism:1": "1", "realism:2": "1"}, "two videos have the same rank"),
        ({"realism:1": "1"}, "about B"),
    ],
)
def test_a_ranking_that_is_no_order_is_refused_and_kept(
    arrive: Arrive, answers: dict[str, str], problem: str
) -> None:
    visitor = arrive("ranking")
    visitor.watch()

    status, refused = submit(visitor, visitor.page(), answers)

    assert status == 422
    assert problem in refused.words("#problem")
    selected = [option["value"] for option in refused.soup.select("[selected]")]
    assert selected == list(answers.values())
    assert count_responses(visitor) == 0


def test_a_slider_is_a_number_field_with_bands_and_no_preset(arrive: Arrive) -> None:
    visitor = arrive("rating", scale="slider")
    visitor.watch()
    page = visitor.page()
    fields = page.soup.select("#answers [type=number]")
    assert fields
    for field in fields:
        assert (field["min"], field["max"], field["value"]) == ("0", "100", "")
        assert "a number from 0 to 100" in field["aria-label"]
    assert {len(bands.select("li")) for bands in page.soup.select(".bands")} == {5}
    numbers = {str(field["name"]): "37" for field in fields}
    first = next(iter(numbers))

    for wrong in ("", "101", "37.5"):
        status, refused = submit(visitor, page, {**filled(page), **numbers, first: wrong})
        assert (status, count_responses(visitor)) == (422, 0)
        assert refused.value(f'[name="{first}"]', "value") == wrong

    assert submit(visitor, page, {**filled(page), **numbers})[0] == 303
