"""Trials of several players over HTTP: what their pages show, and that their forms work."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from bs4 import Tag
from sqlalchemy import select

from motion.segment import EMOTIONS
from studyapp.database.tables import Response, Trial, Video
from studyapp.web.participants.trial_page import EMOTION_WORDS
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import Visitor, filled, stored_in
from tests.support.studies.taking_part_steps import SetClock

Arrive = Callable[..., Visitor]


@pytest.fixture
def arrive(
    tmp_path: Path,
    finished_study: Callable[[str], Path],
    empty_sqlite: Path,
    serve: Serve,
    clock: SetClock,
) -> Arrive:
    """Return a function that brings a participant to the first trial of a protocol's study."""

    def make(protocol: str, scale: str = "mean_opinion") -> Visitor:
        folder = Path(shutil.copytree(finished_study(protocol), tmp_path / protocol))
        shutil.copyfile(empty_sqlite, folder / "responses.db")
        scales = [('scale = "slider"', f'scale = "{scale}"')] if protocol == "rating" else []
        return Visitor(serve(*scales, folder=folder), clock).enrol().begin()

    return make


def count_responses(visitor: Visitor) -> int:
    return len(stored_in(visitor.app, select(Response)))


def trial_at(visitor: Visitor, position: int) -> Trial:
    return stored_in(visitor.app, select(Trial).where(Trial.position == position))[0]


def submit(visitor: Visitor, page: PageReader, answers: dict[str, str]) -> tuple[int, PageReader]:
    sent = visitor.client.post(page.action, data={"trial": page.trial, **answers})
    return sent.status_code, PageReader(sent.text)


def words(tag: Tag | PageReader) -> str:
    text = tag.get_text() if isinstance(tag, Tag) else tag.soup.get_text()
    return " ".join(text.split())


def test_every_emotion_has_words() -> None:
    assert [str(word) for word in EMOTION_WORDS.values()] == list(EMOTIONS) == list(EMOTION_WORDS)


def test_players_are_labelled_in_order_and_under_each_stand_its_questions(arrive: Arrive) -> None:
    page = arrive("rating").page()

    assert [video["data-label"] for video in page.soup.select("video")] == ["A", "B", "C"]
    for number, (player, label) in enumerate(
        zip(page.soup.select(".player"), "ABC", strict=True), 1
    ):
        assert (player["aria-label"], words(player.select(".label")[0])) == (
            f"Video {label}",
            label,
        )
        play, replay = player.select(".controls button")
        assert (words(play), words(replay)) == (f"▶ Play {label}", "↺ Replay")
        assert replay["aria-label"] == f"Replay {label}"
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
    shown = [str(video["id"]) for video in page.soup.select("video")]

    assert visitor.client.post(action, data={"trial": page.trial}).status_code == 422
    for video in shown:
        faults = page.soup.select(f"#{video}-fault [form=unplayable]")
        buttons = page.soup.select(f".trouble li:has([data-reloads={video}]) [form=unplayable]")
        assert [b["value"] for b in faults] == [b["value"] for b in buttons]
    token = str(faults[0]["value"])
    visitor.client.get(str(page.soup.select("video")[-1]["src"]), buffered=True)
    data = {"trial": page.trial, "video": token, "error": "4"}
    answer = visitor.client.post(action, data=data)

    assert answer.status_code == 303
    assert trial_at(visitor, 1).unplayable_at is not None
    named = stored_in(visitor.app, select(Video.token).where(Video.unplayable_at.is_not(None)))
    assert named == [token]
    assert count_responses(visitor) == 0


def test_each_part_is_announced_once_and_its_sound_too(arrive: Arrive) -> None:
    visitor = arrive("mismatch")

    seen = list(visitor.take_trials())

    parts = [trial_at(visitor, position).part for position in range(1, len(seen) + 1)]
    muted = [part == "realism" for part in parts]
    new = [i == 0 or parts[i] != parts[i - 1] for i in range(len(parts))]
    assert [bool(page.soup.select(".part")) for page in seen] == new
    assert [len(page.soup.select("video[muted][data-soundless]")) == 2 for page in seen] == muted
    assert [not page.soup.select("#volume") for page in seen] == muted


def test_attention_checks_look_like_every_page_and_say_what_to_answer(arrive: Arrive) -> None:
    visitor = arrive("rating")

    seen = list(visitor.take_trials())

    (check,) = (n for n in range(1, 4) if trial_at(visitor, n).kind == "attention")
    instructed = trial_at(visitor, check).instructed or 0
    label = ("bad", "poor", "fair", "good", "excellent")[instructed - 1]
    for number, page in enumerate(seen, start=1):
        legends = [words(legend) for legend in page.soup.select("legend")]
        wants = [f"this one with {label}." in text for text in legends]
        assert wants == [number == check] * 6
        assert sum("please answer this one" in text for text in legends) == (number == check)


def test_a_ranking_shows_its_reference_apart_and_asks_for_a_rank_of_each(arrive: Arrive) -> None:
    page = arrive("ranking").page()

    assert [video["data-label"] for video in page.soup.select("video")] == ["Reference", "A", "B"]
    assert words(page.one(".apart .label")) == "Reference"
    assert words(page.one(".aside")) == ("The reference is for comparison; it is not ranked.")
    ranks = page.soup.select("#answers select")
    assert [rank["name"] for rank in ranks] == ["realism:1", "realism:2"]
    assert [rank["aria-label"] for rank in ranks] == [
        "Question 1: rank of video A",
        "Question 1: rank of video B",
    ]
    assert [[option["value"] for option in rank.select("option")] for rank in ranks] == [
        ["", "1", "2"]
    ] * 2
    assert [words(option) for option in ranks[0].select("option")] == [
        "choose …",
        "1st – best",
        "2nd – last",
    ]
    assert page.soup.select("[selected]") == []


@pytest.mark.parametrize(
    ("ranks", "problem"), [(("1", "1"), "two videos have the same rank"), (("1", ""), "about B")]
)
def test_a_ranking_that_is_no_order_is_refused_and_kept(
    arrive: Arrive, ranks: tuple[str, str], problem: str
) -> None:
    visitor = arrive("ranking")
    visitor.watch()
    answers = dict(zip(("realism:1", "realism:2"), ranks, strict=True))

    status, refused = submit(visitor, visitor.page(), {k: v for k, v in answers.items() if v})

    assert status == 422
    assert problem in words(refused.one("#problem"))
    assert [option["value"] for option in refused.soup.select("[selected]")] == [
        rank for rank in ranks if rank
    ]
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
        assert status == 422
        assert count_responses(visitor) == 0
        assert str(refused.one(f'[name="{first}"]')["value"]) == wrong

    assert submit(visitor, page, {**filled(page), **numbers})[0] == 303
