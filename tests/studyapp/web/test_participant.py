"""What a participant's pages say without scripts, and reports of watching that are none."""

import json
from collections.abc import Callable

import pytest
from bs4 import Tag
from flask import Flask
from sqlalchemy import select

from motion.segment import EMOTIONS
from studyapp.database.tables.study_session import FormAnswer
from studyapp.database.tables.trial import Trial
from studyapp.web.participants.trial_page import EMOTION_WORDS
from studyapp.web.protection import AT_ONCE
from tests.studyapp.conftest import OwnStudy
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import Visitor, filled, stored_in, submit
from tests.support.studies.form_questions import FORM, SCALE
from tests.support.studies.taking_part_steps import SetClock

Arrive = Callable[..., Visitor]


def test_a_trial_names_its_emotion_and_preselects_nothing(app: Flask, visitor: Visitor) -> None:
    page = visitor.page()

    (emotion,) = stored_in(app, select(Trial.emotion).where(Trial.position == 1))
    assert page.words(".emotion") == emotion
    assert page.checked() == {}
    labels = [label.get_text(strip=True) for label in page.soup.select(".scale label")]
    assert labels == ["clearly A", "slightly A", "no difference", "slightly B", "clearly B"] * 2
    values = [radio["value"] for radio in page.soup.select("[name=rhythm]")]
    assert values == ["-2", "-1", "0", "1", "2"]


INVALID_REPORTS: list[object] = [
    *(None, [], {"batch": 0}),
    *({"batch": batch, "intervals": []} for batch in (-1, "0")),
    *({"batch": 0, "intervals": [each]} for each in ([0.0], ["a", "b"], [-1.0, 1.0], [1.0, 0.5])),
    {"batch": 0, "intervals": [[0.0, float("nan")]]},
    {"batch": 0, "intervals": [[0.0, 0.1]] * 201},
    *({"batch": 0, "intervals": [], "rate": rate} for rate in (0, float("inf"))),
    {"batch": 0, "intervals": [], "hidden_seconds": -1},
    {"batch": 0, "intervals": [], "silent_seconds": 1e9},
    {"batch": 0, "intervals": [], "stalls": 0.5},
    {"batch": 0, "intervals": [], "frames": -1},
    {"batch": 0, "intervals": [], "speed": 1},
]
INVALID_JSON = [b"", b"\xff\xfe", b"[" * 30_000, b'{"batch": 9' + b"9" * 5000 + b"}", b'"\\ud800"']


def test_a_malformed_watch_report_is_refused(visitor: Visitor) -> None:
    address = visitor.page().value("#pair", "data-watched-url")
    bodies = [json.dumps(report).encode() for report in INVALID_REPORTS] + INVALID_JSON
    assert len(bodies) < AT_ONCE

    for body in bodies:
        assert visitor.client.post(address, data=body).status_code == 422, body


@pytest.mark.parametrize("position", ["", "x", "9" * 5000])
def test_a_break_that_there_is_not_leads_on(visitor: Visitor, position: str) -> None:
    answer = visitor.client.post(f"{visitor.address}/break", data={"position": position})
    assert answer.status_code == 303


GENERATED = ("[conditions.rule_based]", '[conditions.rule_based]\ngenerator = "rule_based"')
MISMATCHED = (
    "[conditions.mismatched]",
    '[conditions.mismatched]\ngenerator = "mismatched"\nsource = "rule_based"',
)
FACE = ("In which video do the gestures fit", "In which video do face and lips fit")
ANOTHER = '\n[[questions]]\nname = "speed"\ntitle = "Speed"\ntext = "Which is calmer?"\n'
KEPT_STILL = "Kept still on purpose in every video: the face and whole-body movement"
FROZEN = ('title = "G', 'freeze = ["face", "root"]\ntitle = "G')


@pytest.mark.parametrize(
    ("changes", "sentences", "unsaid"),
    [
        ((GENERATED, MISMATCHED), ("made by a computer", "gestures, not the face"), "kept still"),
        ((GENERATED,), (), "made by a computer"),
        ((FACE,), ("Judge how the speaker moves",), "not the face"),
        ((FROZEN,), ("Some pairs come more than once", KEPT_STILL), "practice"),
    ],
    ids=["generated", "brought", "face", "frozen"],
)
def test_instructions_follow_the_study_and_never_reveal_practice_trials(
    serve: Serve,
    clock: SetClock,
    changes: tuple[tuple[str, str], ...],
    sentences: tuple[str, ...],
    unsaid: str,
) -> None:
    visitor = Visitor(serve(*changes), clock).enrol()
    text = visitor.page().words()

    assert [sentence for sentence in sentences if sentence not in text] == []
    for page in (text, visitor.begin().page().words()):
        assert unsaid not in page
        assert "ractice" not in page


@pytest.mark.parametrize(
    ("protocol", "added", "sentence"),
    [
        ("mismatch", "", "Answer the question under them."),
        ("mismatch", ANOTHER + 'parts = ["fit"]\n', "Answer all questions under them."),
        ("ranking", "", "Put the videos in order, best first."),
        ("ranking", ANOTHER, "best first, separately for each question."),
        ("ranking", ANOTHER.replace("is calmer", "face is calmer"), "press Larger videos"),
        ("rating", "", "Answer the questions under each video."),
    ],
)
def test_instructions_speak_of_as_many_questions_as_are_asked(
    own_study: OwnStudy, serve: Serve, clock: SetClock, protocol: str, added: str, sentence: str
) -> None:
    app = serve(folder=own_study(protocol).root, added=added)
    assert sentence in Visitor(app, clock).enrol().page().words()


def test_a_language_without_plural_forms_distinguishes_one_question_from_several(
    own_study: OwnStudy, serve: Serve, clock: SetClock
) -> None:
    in_japanese = ("[page]\n", '[page]\nlanguage = "ja"\n')
    app = serve(in_japanese, folder=own_study("ranking").root)
    assert "質問ごとに" not in Visitor(app, clock).enrol().page().words()


def test_texts_of_the_study_file_are_escaped(serve: Serve, clock: SetClock) -> None:
    hostile = "<script>alert(1)</script>' onload='x"
    terms = {
        "title": "Gestures and speech",
        "contact": "gestures@example.org",
        "organisation": "Institute of Gestures",
    }
    payment = 'payment = "2.50 EUR"'
    app = serve(
        *((f'{key} = "{old}"', f'{key} = "{key} {hostile}"') for key, old in terms.items()),
        (payment, f'payment = "payment {hostile}"\nethics = "ethics {hostile}"'),
        ("In which video do the gestures fit", hostile),
        ("You will", hostile),
    )
    visitor = Visitor(app, clock)
    seen = [PageReader(visitor.client.get("/").text), visitor.enrol().page()]
    seen.append(visitor.begin().page())

    for term in (*terms, "payment", "ethics"):
        assert f"{term} {hostile}" in seen[0].soup.get_text()
    assert "10 minutes" in seen[0].soup.get_text()
    for page in seen:
        assert hostile in page.soup.get_text()
        assert all(script.get("src") for script in page.soup.select("script"))
        assert page.soup.select("[onload]") == []


def test_questions_are_asked_before_the_instructions_and_can_be_corrected(serve: Serve) -> None:
    app = serve(added=FORM + SCALE)
    client = app.test_client()
    consent = submit(client, PageReader(client.get("/").text), adult="yes").text
    address = submit(client, PageReader(consent)).location
    page = PageReader(client.get(address).text)
    labels = [label.get_text(strip=True) for label in page.soup.select(".scale label")]
    assert labels == ["1 – never", "2", "3 – every day"]

    # Lines are counted as the browser counts them: this is not longer than 2000.
    lines = "x" * 1990 + "\r\n" * 5 + "x" * 5
    refused = submit(client, page, age="12", work=lines, often="3")
    refused_page = PageReader(refused.text)
    assert refused.status_code == 422
    assert refused_page.value('[name="form:age"]', "value") == "12"
    assert refused_page.checked() == {"form:often": "3"}
    # A browser may open the address of a refused form anew.
    assert client.get(page.action).location == address

    assert submit(client, page, age="21", work=lines, often="3").status_code == 303
    stored = {answer.question: answer.value for answer in stored_in(app, select(FormAnswer))}
    expected = {"adult": "yes", "age": "21", "work": lines.replace("\r\n", "\n"), "often": "3"}
    assert stored == expected
    assert PageReader(client.get(address).text).heading == "What you will do"


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


def test_every_emotion_has_a_wording() -> None:
    assert [str(word) for word in EMOTION_WORDS.values()] == list(EMOTIONS) == list(EMOTION_WORDS)


def test_players_are_labelled_in_order_each_with_its_questions(arrive: Arrive) -> None:
    page = arrive("rating").page()

    assert [video["data-label"] for video in page.soup.select("video")] == ["A", "B", "C"]
    for number, (player, label) in enumerate(
        zip(page.soup.select(".player"), "ABC", strict=True), 1
    ):
        assert (player["aria-label"], words(player.select(".label")[0])) == (
            f"Video {label}",
            label,
        )
        fields = {str(radio["name"]) for radio in player.select("[type=radio]")}
        assert fields == {f"quality:{number}", f"synchrony:{number}"}
        for question in player.select(".question"):
            labels = [words(label) for label in question.select(".scale label")]
            assert labels == ["bad", "poor", "fair", "good", "excellent"]
            assert [radio["value"] for radio in question.select("[type=radio]")] == list("12345")
    assert page.checked() == {}


def test_each_part_and_its_sound_are_announced_once(arrive: Arrive) -> None:
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


def test_a_ranking_shows_its_reference_separately_and_asks_for_every_rank(arrive: Arrive) -> None:
    page = arrive("ranking").page()

    assert [video["data-label"] for video in page.soup.select("video")] == ["Reference", "A", "B"]
    assert page.words(".apart .label") == "Reference"
    assert page.soup.select("main > noscript")
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
