"""What a participant's pages say, and reports of watching that are none."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from flask import Flask
from sqlalchemy import select

from studyapp.database.tables import FormAnswer, Trial
from studyapp.web.protection import AT_ONCE
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import Visitor, stored_in
from tests.support.studies.asked_forms import FORM, SCALE
from tests.support.studies.taking_part_steps import SetClock


@pytest.fixture
def visitor(app: Flask, clock: SetClock) -> Visitor:
    """Return a participant at the first trial."""
    return Visitor(app, clock).enrol().begin()


def test_a_trial_asks_of_its_emotion_and_preselects_nothing(app: Flask, visitor: Visitor) -> None:
    page = visitor.page()

    (trial,) = stored_in(app, select(Trial).where(Trial.position == 1))
    assert page.one(".emotion").get_text() == trial.emotion
    assert page.checked() == {}
    labels = [label.get_text(strip=True) for label in page.soup.select(".scale label")]
    assert labels == ["clearly A", "slightly A", "no difference", "slightly B", "clearly B"] * 2
    values = [radio["value"] for radio in page.soup.select("[name=rhythm]")]
    assert values == ["-2", "-1", "0", "1", "2"]


INVALID_REPORTS: list[object] = [
    None,
    [],
    {"batch": 0},
    {"batch": -1, "intervals": []},
    {"batch": "0", "intervals": []},
    {"batch": 0, "intervals": [[0.0]]},
    {"batch": 0, "intervals": [["a", "b"]]},
    {"batch": 0, "intervals": [[0.0, float("nan")]]},
    {"batch": 0, "intervals": [[-1.0, 1.0]]},
    {"batch": 0, "intervals": [[0.0, 0.1]] * 201},
    {"batch": 0, "intervals": [[1.0, 0.5]]},
    {"batch": 0, "intervals": [], "rate": 0},
    {"batch": 0, "intervals": [], "rate": float("inf")},
    {"batch": 0, "intervals": [], "hidden_seconds": -1},
    {"batch": 0, "intervals": [], "silent_seconds": 1e9},
    {"batch": 0, "intervals": [], "stalls": 0.5},
    {"batch": 0, "intervals": [], "frames": -1},
    {"batch": 0, "intervals": [], "speed": 1},
]
INVALID_JSON = [b"", b"\xff\xfe", b"[" * 30_000, b'{"batch": 9' + b"9" * 5000 + b"}", b'"\\ud800"']


def test_a_report_of_watching_that_is_none_is_refused(visitor: Visitor) -> None:
    address = visitor.page().value("#pair", "data-watched-url")
    bodies = [json.dumps(report).encode() for report in INVALID_REPORTS] + INVALID_JSON
    assert len(bodies) < AT_ONCE

    for body in bodies:
        assert visitor.client.post(address, data=body).status_code == 422, body


def instructions(app: Flask) -> str:
    text = Visitor(app, SetClock()).enrol().page().text
    return re.sub(r"\s+", " ", text)


GENERATED = (
    ("[conditions.rule_based]", '[conditions.rule_based]\ngenerator = "rule_based"'),
    (
        "[conditions.mismatched]",
        '[conditions.mismatched]\ngenerator = "mismatched"\nsource = "rule_based"',
    ),
)


def test_instructions_say_that_no_motion_is_recorded_where_all_of_it_is_generated(
    serve: Serve, tiny_study: Path, tmp_path: Path
) -> None:
    urls = (f"sqlite:///{tmp_path / name}.db" for name in ("brought", "recorded"))
    generated = instructions(serve(*GENERATED))
    assert "made by a computer" in generated
    assert "Judge the gestures, not the face" in generated
    assert "kept still" not in generated
    assert "practice" not in generated
    brought = (GENERATED[1][1], GENERATED[1][0])
    assert "made by a computer" not in instructions(serve(brought, database_url=next(urls)))
    stimuli = tiny_study / "stimuli.json"
    stimuli.write_text(stimuli.read_text("utf-8").replace("rule_based", "ground_truth"), "utf-8")
    recorded = serve(
        (GENERATED[0][1], "[conditions.ground_truth]"),
        ('"rule_based"', '"ground_truth"'),
        database_url=next(urls),
    )
    assert "made by a computer" not in instructions(recorded)


def test_instructions_follow_the_study(serve: Serve) -> None:
    app = serve(('title = "G', 'freeze = ["face", "root"]\ntitle = "G'))
    text = instructions(app)
    assert "ractice" not in text
    assert "ractice" not in Visitor(app, SetClock()).enrol().begin().page().text
    assert "Some pairs come more than once" in text
    assert "Kept still on purpose in every video: the face and whole-body movement" in text


def test_what_the_study_file_says_is_shown_as_text_never_as_markup(
    serve: Serve, clock: SetClock
) -> None:
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


@pytest.fixture
def form_app(serve: Serve) -> Flask:
    """Return the application of a study that asks about its participants."""
    return serve(added=FORM + SCALE)


def stored_answers(app: Flask) -> dict[str, str]:
    return {answer.question: answer.value for answer in stored_in(app, select(FormAnswer))}


@pytest.fixture
def address(form_app: Flask) -> str:
    """Return where somebody who is eligible goes on."""
    client = form_app.test_client()
    visit = PageReader(client.get("/").text).value("[name=visit]", "value")
    return client.post("/", data={"visit": visit, "form:adult": "yes"}).location or ""


def test_questions_are_asked_before_the_instructions_and_can_be_corrected(
    form_app: Flask, address: str
) -> None:
    client = form_app.test_client()
    page = PageReader(client.get(address).text)
    labels = [label.get_text(strip=True) for label in page.soup.select(".scale label")]
    assert labels == ["1 – never", "2", "3 – every day"]

    answers = {"form:age": "12", "form:work": "", "form:often": "3"}
    refused = client.post(page.action, data=answers)
    refused_page = PageReader(refused.text)
    assert refused.status_code == 422
    assert refused_page.value('[name="form:age"]', "value") == "12"
    assert refused_page.checked() == {"form:often": "3"}

    accepted = client.post(page.action, data=answers | {"form:age": "21"})
    assert accepted.status_code == 303
    assert stored_answers(form_app) == {"adult": "yes", "age": "21", "work": "", "often": "3"}
    assert PageReader(client.get(address).text).heading == "What you will do"


def test_lines_are_counted_and_stored_as_the_browser_counts_them(
    form_app: Flask, address: str
) -> None:
    client = form_app.test_client()
    page = PageReader(client.get(address).text)
    lines = "x" * 1990 + "\r\n" * 5 + "x" * 5

    client.post(page.action, data={"form:age": "21", "form:work": lines, "form:often": "3"})

    assert stored_answers(form_app)["work"] == lines.replace("\r\n", "\n")
