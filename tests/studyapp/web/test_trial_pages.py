"""Trials of several players over HTTP: what their pages show, and that their forms work."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from bs4 import Tag
from sqlalchemy import select

from motion.segment import EMOTIONS
from studyapp.database.tables import Trial
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


def trials(visitor: Visitor) -> list[Trial]:
    return list(stored_in(visitor.app, select(Trial).order_by(Trial.position)))


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
    first = str(fields[0]["name"])

    # What is refused is kept on the page.
    for wrong in ("", "101", "37.5"):
        data = {**filled(page), first: wrong}
        refused = PageReader(visitor.client.post(page.action, data=data).text)
        assert refused.soup.select("#problem")
        assert refused.value(f'[name="{first}"]', "value") == wrong
