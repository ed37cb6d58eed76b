"""Rendering the templates of study files, and their texts for participants in other languages."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
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
    """Return a key as a line of a study file, commented out if it has no value."""
    if isinstance(value, Undefined):
        return f"# {name} = {example}"
    return f"{name} = {_toml(value)}"


def _toml(value: object) -> str:
    return tomlkit.item(value).as_string()


_TEMPLATES.globals["key"] = _key
_TEMPLATES.filters["toml"] = _toml


def render_template(file: str, language: str = TEMPLATE_LANGUAGE, **variables: object) -> str:
    """Return a template filled with `variables`, or its texts in another language."""
    name = file if language == TEMPLATE_LANGUAGE else f"{language}/{file}"
    return _TEMPLATES.get_template(name).render(variables)


def translate_study_file(text: str, file: str, language: str, *, title: str | None) -> str:
    """Return a study file with the texts and pages for participants in `language`.

    Parameters
    ----------
    text : str
        The study file, rendered from a template.
    file : str
        The template's file name.
    language : {'en', 'de', 'ja'}
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
    """Replace the texts of `questions` by the translated `texts` of the same names."""
    by_name = {text["name"]: text for text in texts}
    for question in questions:
        for key, translation in by_name[question["name"]].items():
            if key != "name":
                question[key] = (
                    _multiline_array(translation) if isinstance(translation, list) else translation
                )


def _multiline_array(items: list[Any]) -> tomlkit.items.Array:
    """Return an array with one item a line."""
    array = tomlkit.array()
    for item in items:
        if isinstance(item, dict):
            table = tomlkit.inline_table()
            table.update(item)
            array.append(table)
        else:
            array.append(item)
    return array.multiline(multiline=True)


def template_texts(files: Iterable[str], language: str) -> tuple[set[str], set[str], set[str]]:
    """Return the titles, consent texts and question texts of templates in `language`."""
    templates = [tomllib.loads(render_template(file, language)) for file in files]
    return (
        {template["title"] for template in templates},
        {template["page"]["consent"] for template in templates},
        {question["text"] for template in templates for question in template["questions"]},
    )


def untranslated_keys(study: Study) -> tuple[str, ...]:
    """Return the keys with the text of an English template, if the pages are not in English.

    Texts that a researcher wrote cannot be judged.
    """
    if study.page.language == TEMPLATE_LANGUAGE:
        return ()
    names = [name for name in _TEMPLATES.list_templates() if "/" not in name]
    titles, consents, texts = template_texts(names, TEMPLATE_LANGUAGE)
    return (
        *(["title"] if study.title in titles else []),
        *(["page.consent"] if study.page.consent in consents else []),
        *(f"the question {each.name!r}" for each in study.questions if each.text in texts),
    )
