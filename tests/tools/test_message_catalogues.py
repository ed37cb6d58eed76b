"""Every text for participants is translated into every language."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from babel.messages.catalog import Catalog, Message

from studyapp.study.settings.presentation import Page
from studyapp.web.language import SOURCE, catalogue_path
from tools import message_catalogues
from tools.message_catalogues import (
    TRANSLATED,
    catalogue_of,
    read_catalogue,
    source_texts,
    texts_of_code,
    updated,
)

PLACE = re.compile(r"%\((\w+)\)s|{(\w+)}")
TAG = re.compile(r"</?\w+")
LETTERS = {"de": re.compile(r"[A-Za-zÄÖÜäöüß]"), "ja": re.compile(r"[ぁ-んァ-ヶ一-龯]")}


def texts(message: Message) -> list[str]:
    """Return the English forms of a message."""
    return [message.id] if isinstance(message.id, str) else list(message.id)


def translations(message: Message) -> list[str]:
    return [message.string] if isinstance(message.string, str) else list(message.string or ())


def places(text: str) -> set[str]:
    return {place or other for place, other in PLACE.findall(text)}


@pytest.fixture(scope="module")
def template() -> Catalog:
    return catalogue_of(source_texts())


@pytest.fixture(params=TRANSLATED)
def catalogue(request: pytest.FixtureRequest) -> Catalog:
    return read_catalogue(request.param)


def entries(catalogue: Catalog) -> Iterator[Message]:
    return (message for message in catalogue if message.id)


def test_a_study_can_be_in_english_and_in_every_translated_language() -> None:
    languages = Page.model_json_schema()["properties"]["language"]["enum"]

    assert set(languages) == {SOURCE, *TRANSLATED}


def test_the_catalogue_has_exactly_the_texts_in_use(catalogue: Catalog, template: Catalog) -> None:
    known = {message.id for message in entries(catalogue)}
    used = {message.id for message in entries(template)}

    assert sorted(map(str, used - known)) == [], "run 'make messages' and translate these"
    assert sorted(map(str, known - used)) == [], "run 'make messages': these are no longer used"
    assert not catalogue.obsolete


def test_the_catalogue_is_formatted_by_its_tool(catalogue: Catalog, template: Catalog) -> None:
    written = catalogue_path(str(catalogue.locale)).read_text("utf-8")

    assert updated(catalogue, template) == written, "run 'make messages'"


def test_every_text_is_translated_in_as_many_forms_as_the_language_has(catalogue: Catalog) -> None:
    for message in entries(catalogue):
        assert not message.fuzzy, message.id
        assert all(translations(message)), message.id
        expected = catalogue.num_plurals if message.pluralizable else 1
        assert len(translations(message)) == expected, message.id


def test_a_translation_keeps_placeholders_and_marks(catalogue: Catalog) -> None:
    for message in entries(catalogue):
        forms, translated = texts(message), translations(message)
        # The form for many things is the one that every language has.
        assert places(translated[-1]) == places(forms[-1]), message.id
        assert all(places(form) <= places(forms[-1]) for form in translated), message.id
        assert {tuple(sorted(TAG.findall(form))) for form in translated} == {
            tuple(sorted(TAG.findall(form))) for form in forms
        }, message.id
        for form in translated:
            assert form.strip() == form or message.id == ", ", message.id
            assert "%" not in PLACE.sub("", form).replace("%%", ""), message.id


def test_a_translation_is_in_its_language(catalogue: Catalog) -> None:
    letters = LETTERS[str(catalogue.locale)]
    for message in entries(catalogue):
        words = PLACE.sub("", TAG.sub("", texts(message)[-1]))
        if len(re.findall(r"[A-Za-z]+", words)) < 3:
            continue  # a word may be the same, or stand beside a place as a mark
        assert all(letters.search(form) for form in translations(message)), message.id
        assert set(translations(message)) != set(texts(message)), message.id


@pytest.mark.parametrize(
    "written",
    [
        '_(f"Question {n}")',
        "_(words)",
        'raise UnacceptableError("What.", "a" + remedy)',
        'raise UnacceptableError("What.")',
    ],
)
def test_a_text_that_cannot_be_extracted_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, written: str
) -> None:
    monkeypatch.setattr(message_catalogues, "ROOT", tmp_path)
    (tmp_path / "code.py").write_text(written, "utf-8")

    with pytest.raises(ValueError, match=r"code\.py:1: .* not a literal"):
        list(texts_of_code(tmp_path / "code.py"))
