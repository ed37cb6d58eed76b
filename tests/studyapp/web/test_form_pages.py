"""Questions about the participant, and pages that ask for one certain answer."""

from __future__ import annotations

from dataclasses import replace

import pytest
from flask import Flask
from sqlalchemy import select

from studyapp.database.tables import FormAnswer, Trial
from studyapp.web.participants.trial_page import SCALE as SCALE_WORDS
from studyapp.web.running import attach, running
from tests.studyapp.session.test_form_answers import FORM
from tests.studyapp.taking_part_steps import SetClock
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import Visitor
from tests.studyapp.web.walking import Walker

SCALE = """
[[form.demographics]]
name = "often"
text = "How often do you watch animated films?"
kind = "scale"
low = 1
high = 3
choices = ["never", "every day"]
"""


@pytest.fixture
def asking(serve: Serve) -> Flask:
    """Return the application of a study that asks about its participants."""
    return serve(added=FORM + SCALE)


def stored(app: Flask) -> dict[str, str]:
    with app.app_context(), running().database.reading() as session:
        return {answer.question: answer.value for answer in session.scalars(select(FormAnswer))}


def at_the_entrance(app: Flask, answer: str | None) -> tuple[int, PageReader, str | None]:
    client = app.test_client()
    page = PageReader(client.get("/").text)
    visit = page.value("[name=visit]", "value")
    given = {} if answer is None else {"form:adult": answer}
    sent = client.post("/", data={"visit": visit, **given})
    return sent.status_code, PageReader(sent.text), sent.location


def test_the_entrance_asks_and_keeps_what_was_answered(asking: Flask) -> None:
    page = PageReader(asking.test_client().get("/").text)
    assert [r["value"] for r in page.soup.select('[name="form:adult"]')] == ["yes", "no"]

    status, refused, _ = at_the_entrance(asking, None)

    assert status == 422
    assert "Question 1 is not answered yet" in refused.one(".problem").get_text()
    assert refused.value("[name=visit]", "value")


def test_who_is_not_eligible_is_told_kindly(asking: Flask) -> None:
    status, page, _ = at_the_entrance(asking, "no")

    assert status == 403
    assert "looks for other participants" in page.heading
    assert stored(asking) == {}


def test_questions_are_asked_before_the_instructions_and_can_be_corrected(asking: Flask) -> None:
    _, _, address = at_the_entrance(asking, "yes")
    client = asking.test_client()
    page = PageReader(client.get(address or "").text)
    labels = [label.get_text(strip=True) for label in page.soup.select(".scale label")]
    assert labels == ["1 – never", "2", "3 – every day"]

    answers = {"form:age": "12", "form:work": "", "form:often": "3"}
    refused = client.post(page.action, data=answers)
    kept = PageReader(refused.text)
    assert refused.status_code == 422
    assert kept.value('[name="form:age"]', "value") == "12"
    assert kept.checked() == {"form:often": "3"}

    accepted = client.post(page.action, data=answers | {"form:age": "21"})
    assert accepted.status_code == 303
    assert stored(asking) == {"adult": "yes", "age": "21", "work": "", "often": "3"}
    assert PageReader(client.get(address or "").text).heading == "What you will do"


def test_a_closing_question_has_room_for_several_lines(asking: Flask, clock: SetClock) -> None:
    with asking.app_context():
        attach(asking, replace(running(), clock=clock))
    *_, asked, _ = Walker(asking, clock).pages()
    assert asked.one("textarea")["name"] == "form:comment"
    assert stored(asking)["comment"] == "–"


def test_lines_are_counted_and_stored_as_the_browser_counts_them(asking: Flask) -> None:
    _, _, address = at_the_entrance(asking, "yes")
    client = asking.test_client()
    page = PageReader(client.get(address or "").text)
    lines = "x" * 1990 + "\r\n" * 5 + "x" * 5

    client.post(page.action, data={"form:age": "21", "form:work": lines, "form:often": "3"})

    assert stored(asking)["work"] == lines.replace("\r\n", "\n")


def test_an_attention_check_looks_like_every_page_and_says_what_to_answer(
    serve: Serve, clock: SetClock
) -> None:
    checking = serve(added="\n[attention]\ntrials = 1\n")
    visitor = Visitor(checking, clock).enrol().begin()
    with checking.app_context(), running().database.reading() as session:
        trials = session.scalars(select(Trial).order_by(Trial.position)).all()
        (check,) = (trial for trial in trials if trial.kind == "attention")
    shapes = []
    while (page := visitor.page()).soup.select("#answers"):
        shapes.append([(tag.name, tag.get("name")) for tag in page.soup.select("main *")])
        if len(shapes) == check.position:
            asked = [legend.get_text() for legend in page.soup.select("legend")]
        visitor.watch()
        visitor.post(page)

    words = str(dict(SCALE_WORDS)[check.instructed or 0])
    assert all(f"this one with {words}." in text for text in asked)
    assert ["please" in text for text in asked] == [True, False]
    assert {len(shape) for shape in shapes} <= {len(shapes[0]), len(shapes[0]) + 1}
    assert len(shapes) == 7
