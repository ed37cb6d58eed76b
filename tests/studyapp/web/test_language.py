"""Every page of every study says everything in the language of the study, and says it well.

A made-up language puts brackets around each text. What stands outside them would be English for
everybody.
"""

from pathlib import Path

import pytest
from flask import Flask

from studyapp.session.refusal import UnacceptableError
from studyapp.study.settings.presentation import Message
from studyapp.study.settings.study import Study
from studyapp.web.errors import note_and_explain
from studyapp.web.language import language_of, speak
from studyapp.web.site import site_of
from tests.functional.shown_studies import NAMES, write_shown_study
from tests.studyapp.web.brackets import bracketed, left_in_english
from tests.studyapp.web.conftest import Serve
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import Visitor
from tests.support.studies.redefining import edited
from tests.support.studies.taking_part_steps import SetClock


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("studies")


@pytest.fixture
def folder(folders: Path, request: pytest.FixtureRequest) -> Path:
    """Return the folder of a study, made once for all languages."""
    folder: Path = folders / request.param
    if not folder.exists():
        write_shown_study(folder, request.param)
        with edited(folder / "study.toml") as document:
            document["page"]["sound_check"] = True
    return folder


@pytest.fixture
def visitor(folder: Path, serve: Serve, tmp_path: Path, clock: SetClock) -> Visitor:
    database_url = f"sqlite:///{tmp_path / 'walked.db'}"
    return Visitor(serve(folder=folder, database_url=database_url), clock)


def study_of(app: Flask) -> Study:
    return site_of(app).study


@pytest.mark.parametrize("folder", NAMES, indirect=True)
def test_every_text_of_the_study_pages_is_translated(visitor: Visitor) -> None:
    speak(visitor.app, bracketed())
    study = study_of(visitor.app)

    for page in visitor.every_page():
        assert left_in_english(page, study) == "", page.heading


@pytest.mark.parametrize("folder", ["players"], indirect=True)
def test_every_text_of_the_side_pages_is_translated(visitor: Visitor, clock: SetClock) -> None:
    speak(visitor.app, bracketed())
    study = study_of(visitor.app)
    pages = visitor.every_page()
    while not visitor.address:
        next(pages)
    beside = [
        visitor.client.get(f"{visitor.address}/withdraw"),
        visitor.client.get("/nowhere"),
        visitor.client.get("/take/nobody"),
        visitor.client.put("/"),
        visitor.client.post("/", data={"visit": "too short"}),
        visitor.client.post("/", data={"visit": "x" * 70_000}),
        visitor.client.post(f"{visitor.address}/answers", data={"trial": "none"}),
        visitor.client.post(f"{visitor.address}/form/closing", data={}),
    ]
    withdrawal = PageReader(beside[0].text)
    beside += [
        visitor.client.post(withdrawal.action, follow_redirects=True),
        visitor.client.post(f"{visitor.address}/answers", data={"trial": "none"}),
    ]

    for answer in beside:
        assert left_in_english(PageReader(answer.text), study) == "", answer.status


def test_the_check_finds_untranslated_text(serve: Serve) -> None:
    study = study_of(serve())
    page = PageReader(f'<p title="⟦Help⟧ me">⟦say ⟦it⟧⟧ now, {study.title} A</p>')

    assert left_in_english(page, study) == "now me"


def speaking(code: str) -> Flask:
    app = Flask("test")
    speak(app, language_of(code))
    return app


@pytest.mark.parametrize(
    ("code", "message"),
    [
        ("en", "Questions not answered yet: 1, 2 about B and 3. Please wait."),
        ("de", "Noch nicht beantwortete Fragen: 1, 2 zu B und 3. Please wait."),
        ("ja", "まだ回答していない質問：1、2（B）、3。Please wait."),
    ],
)
def test_a_refusal_is_shown_in_full_with_its_list(code: str, message: str) -> None:
    about = Message("{number} about {letter}", number=2, letter="B")
    refusal = UnacceptableError(
        "Questions not answered yet: {numbers}.", "Please wait.", numbers=(1, about, 3)
    )

    with speaking(code).test_request_context():
        assert note_and_explain(refusal) == message
