"""The language of a study's pages: one for the whole application, named in the study's file.

The English texts are in the code that uses them. Their translations are
``catalogues/<language>/LC_MESSAGES/messages.po``, compiled in memory when the application starts.
"""

import gettext as gettext_files
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Final, cast

from babel import Locale
from babel.lists import format_list
from babel.messages.catalog import Catalog
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po
from flask import Flask, current_app

from studyapp.study.settings.presentation import Message

CATALOGUES: Final = Path(__file__).parent / "catalogues"
SOURCE: Final = "en"
"""The language of the texts in templates and code."""

REGIONS: Final = {SOURCE: "en_GB"}
"""Regions of languages that are written in more than one way."""

EXTENSION: Final = "motionjury-language"
COUNTS: Final = range(200)
"""Numbers among which every plural form of a language occurs."""

ScriptTexts = Mapping[str, str | Mapping[str, str]]
"""Translations of the scripts' texts; those with a plural by its category (CLDR)."""


@dataclass(frozen=True, kw_only=True)
class Language:
    """The language that pages are written in.

    Attributes
    ----------
    code : str
        Its name in ``study.toml`` and in HTML.
    locale : Locale
        How it writes lists and numbers.
    texts : gettext translations
        Translations of the English texts.
    script_texts : mapping
        Those that `static/words.js` needs.
    """

    code: str
    locale: Locale
    texts: gettext_files.NullTranslations
    script_texts: ScriptTexts

    @property
    def direction(self) -> str:
        """Which way it is written: ``ltr`` or ``rtl``."""
        return self.locale.text_direction

    def listed(self, words: Sequence[str]) -> str:
        """Return ``a, b and c``."""
        return format_list(words, locale=self.locale)

    def either(self, words: Sequence[str]) -> str:
        """Return ``a, b or c``."""
        return format_list(words, style="or", locale=self.locale)

    def say(self, message: Message) -> str:
        """Return `message` in this language."""
        return message.render(self.texts.gettext, self.listed)


@cache
def language_of(code: str) -> Language:
    """Return the language named `code`: English, or one that has a catalogue."""
    locale = Locale.parse(REGIONS.get(code, code))
    if code == SOURCE:
        texts = gettext_files.NullTranslations()
        return Language(code=code, locale=locale, texts=texts, script_texts={})
    with catalogue_path(code).open("rb") as file:
        catalogue = read_po(file, locale=code)
    compiled = io.BytesIO()
    write_mo(compiled, catalogue)
    compiled.seek(0)
    texts = gettext_files.GNUTranslations(compiled)
    return Language(
        code=code, locale=locale, texts=texts, script_texts=_script_texts(catalogue, locale, texts)
    )


def catalogue_path(code: str) -> Path:
    """Return where the translations into `code` are."""
    return CATALOGUES / code / "LC_MESSAGES" / "messages.po"


def _script_texts(
    catalogue: Catalog, locale: Locale, texts: gettext_files.NullTranslations
) -> ScriptTexts:
    """Return the translations of the scripts' texts."""
    script_texts: dict[str, str | Mapping[str, str]] = {}
    for message in catalogue:
        if not any(file.endswith(".js") for file, _ in message.locations):
            continue
        if isinstance(message.id, str):
            script_texts[message.id] = texts.gettext(message.id)
        else:
            one, many = message.id
            script_texts[one] = {
                locale.plural_form(n): texts.ngettext(one, many, n) for n in COUNTS
            }
    return script_texts


def speak(app: Flask, language: Language) -> None:
    """Write the pages of `app` in `language`."""
    app.extensions[EXTENSION] = language
    app.jinja_env.add_extension("jinja2.ext.i18n")
    # The method is the extension's own; type checkers do not know it.
    install = app.jinja_env.install_gettext_callables  # type: ignore[attr-defined]
    install(language.texts.gettext, language.texts.ngettext, newstyle=True)
    app.jinja_env.filters["listed"] = language.listed
    app.jinja_env.filters["said"] = language.say
    app.jinja_env.globals["language"] = language


def page_language() -> Language:
    """Return the language of the pages of the present request."""
    return cast(Language, current_app.extensions[EXTENSION])


def _(text: str, /, **values: object) -> str:
    """Return `text` in the page's language, ``%(places)s`` filled with `values`."""
    return page_language().texts.gettext(text) % values


def say(message: Message) -> str:
    """Return `message` in the page's language."""
    return page_language().say(message)
