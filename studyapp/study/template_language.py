"""What participants read of a template, in the language of the study's pages."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from typing import Any, Final

import tomlkit
from jinja2 import ChainableUndefined, Environment, PackageLoader, Undefined

from studyapp.study.settings.study import Study

TEMPLATE_LANGUAGE: Final = "en"
"""The language of the templates themselves."""


_TEMPLATES: Final = Environment(
    loader=PackageLoader("studyapp.study"),
    undefined=ChainableUndefined,
    trim_blocks=True,
    keep_trailing_newline=True,
    autoescape=False,  # noqa: S701  (study files are TOML, not HTML)
)


def _key(name: str, example: object, value: object) -> str:
    """Return a line of a study file, in a comment where nothing is stated."""
    if isinstance(value, Undefined):
        return f"# {name} = {example}"
    return f"{name} = {_toml(value)}"


def _toml(value: object) -> str:
    return tomlkit.item(value).as_string()


_TEMPLATES.globals["key"] = _key
_TEMPLATES.filters["toml"] = _toml


def render_template(file: str, language: str = TEMPLATE_LANGUAGE, **stated: object) -> str:
    """Return a template with what is stated in it, or its texts in another language."""
    name = file if language == TEMPLATE_LANGUAGE else f"{language}/{file}"
    return _TEMPLATES.get_template(name).render(stated)


def translate_study_file(text: str, file: str, language: str, *, title: str | None) -> str:
    """Return a study file with what participants read in a language, and its pages too.

    Parameters
    ----------
    text : str
        The study file, made from a template.
    file : str
        Name of the template's file.
    language : {'en', 'de', 'ja'}
        The language.
    title : str or None
        The study's own title, which stays; None for the template's.
    """
    if language == TEMPLATE_LANGUAGE:
        return text
    document = tomlkit.parse(text)
    texts = tomllib.loads(render_template(file, language))
    document["title"] = title or texts["title"]
    page: Any = document["page"]
    page["language"] = language
    page["consent"] = tomlkit.string(texts["page"]["consent"], multiline=True)
    _replace_texts(document["questions"], texts["questions"])
    form: Any = document.get("form", {})
    for stage, questions in texts.get("form", {}).items():
        _replace_texts(form[stage], questions)
    return tomlkit.dumps(document)


def _replace_texts(questions: Any, texts: Sequence[Mapping[str, Any]]) -> None:
    """Replace what `texts` say of each of `questions`, found by its name."""
    by_name = {text["name"]: text for text in texts}
    for question in questions:
        for key, translation in by_name[question["name"]].items():
            if key != "name":
                question[key] = (
                    _multiline_array(translation) if isinstance(translation, list) else translation
                )


def _multiline_array(items: list[Any]) -> tomlkit.items.Array:
    """Return a list with a line for each item."""
    array = tomlkit.array()
    for each in items:
        if isinstance(each, dict):
            table = tomlkit.inline_table()
            table.update(each)
            array.append(table)
        else:
            array.append(each)
    return array.multiline(multiline=True)


def untranslated_keys(study: Study) -> tuple[str, ...]:
    """Return the keys that still say what an English template says, though the pages do not.

    Nothing can be said of texts that a researcher has written.
    """
    if study.page.language == TEMPLATE_LANGUAGE:
        return ()
    sources = [
        tomllib.loads(render_template(name))
        for name in _TEMPLATES.list_templates()
        if "/" not in name
    ]
    asked = {question["text"] for source in sources for question in source["questions"]}
    same = {
        "title": study.title in {source["title"] for source in sources},
        "page.consent": study.page.consent in {source["page"]["consent"] for source in sources},
        **{
            f"the question {question.name!r}": question.text in asked
            for question in study.questions
        },
    }
    return tuple(key for key, is_same in same.items() if is_same)
