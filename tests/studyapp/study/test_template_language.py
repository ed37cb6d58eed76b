from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from studyapp.study.settings.reading import read_study
from studyapp.study.settings.study import Study
from studyapp.study.study_file import new_study
from studyapp.study.template_language import untranslated_keys

TEMPLATES = ("pairwise", "rating", "ranking", "mismatch", "three-systems")


def made(path: Path, template: str, language: Any) -> tuple[Study, str]:
    study = new_study(path, template=template, language=language, name="study")
    assert read_study(path) == study
    return study, path.read_text("utf-8")


def read_by_participants(text: str) -> dict[str, str]:
    """Return every text for participants in a study file, by its role."""
    study = tomllib.loads(text)
    read = {"title": study["title"], "consent": study["page"]["consent"]}
    for question in study["questions"]:
        name = question["name"]
        read[name] = question["text"]
        read |= {f"{name} {n}": label for n, label in enumerate(question.get("labels", ()))}
        read |= {f"{name} {r['name']}": r["text"] for r in question.get("reasons", ())}
    for question in study.get("form", {}).get("eligibility", ()):
        name = question["name"]
        read |= {name: question["text"], f"{name} eligible": question["eligible"][0]}
        read |= {f"{name} {n}": choice for n, choice in enumerate(question["choices"])}
    return read


@pytest.mark.parametrize("language", ["de", "ja"])
@pytest.mark.parametrize("template", TEMPLATES)
def test_a_translated_template_differs_only_in_its_language(
    tmp_path: Path, template: str, language: str
) -> None:
    english, source = made(tmp_path / "en.toml", template, "en")
    study, text = made(tmp_path / "study.toml", template, language)

    before, after = read_by_participants(source), read_by_participants(text)
    assert before.keys() == after.keys()
    assert [name for name in before if before[name] == after[name]] == []
    assert all(("{emotion}" in before[name]) is ("{emotion}" in after[name]) for name in before)
    assert study.page.language == language
    assert re.findall(r"^# .*", source, re.M) == re.findall(r"^# .*", text, re.M)
    said: dict[str, Any] = {"title": ..., "questions": {"__all__": {"text", "labels", "reasons"}}}
    said["page"] = {"language", "consent"}
    said["form"] = {"eligibility": {"__all__": {"text", "choices", "eligible"}}}
    assert study.model_dump(exclude=said) == english.model_dump(exclude=said)


def test_a_given_title_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"

    assert new_study(path, name="s", language="ja", title="Mine").title == "Mine"


@pytest.mark.parametrize("template", TEMPLATES)
def test_texts_left_from_the_english_template_are_named(tmp_path: Path, template: str) -> None:
    english, source = made(tmp_path / "en.toml", template, "en")
    german, _ = made(tmp_path / "de.toml", template, "de")
    mixed = tmp_path / "mixed.toml"
    mixed.write_text(source.replace('language = "en"', 'language = "de"'), "utf-8")

    assert untranslated_keys(english) == untranslated_keys(german) == ()
    assert untranslated_keys(read_study(mixed)) == (
        "title",
        "page.consent",
        *(f"the question {question.name!r}" for question in english.questions),
    )
