"""Questions about the participant, and pages that ask for one certain answer."""

from __future__ import annotations

import pytest
from flask import Flask
from sqlalchemy import select

from studyapp.database.tables import FormAnswer
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import stored_in
from tests.support.studies.asked_forms import FORM, SCALE


@pytest.fixture
def asking(serve: Serve) -> Flask:
    """Return the application of a study that asks about its participants."""
    return serve(added=FORM + SCALE)


def stored(app: Flask) -> dict[str, str]:
    return {answer.question: answer.value for answer in stored_in(app, select(FormAnswer))}


@pytest.fixture
def address(asking: Flask) -> str:
    """Return where somebody who is eligible goes on."""
    client = asking.test_client()
    visit = PageReader(client.get("/").text).value("[name=visit]", "value")
    return client.post("/", data={"visit": visit, "form:adult": "yes"}).location or ""


def test_questions_are_asked_before_the_instructions_and_can_be_corrected(
    asking: Flask, address: str
) -> None:
    client = asking.test_client()
    page = PageReader(client.get(address).text)
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
    assert PageReader(client.get(address).text).heading == "What you will do"


def test_lines_are_counted_and_stored_as_the_browser_counts_them(
    asking: Flask, address: str
) -> None:
    client = asking.test_client()
    page = PageReader(client.get(address).text)
    lines = "x" * 1990 + "\r\n" * 5 + "x" * 5

    client.post(page.action, data={"form:age": "21", "form:work": lines, "form:often": "3"})

    assert stored(asking)["work"] == lines.replace("\r\n", "\n")
