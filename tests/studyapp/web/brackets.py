"""A made-up language that brackets each text: what stands outside is English."""

import gettext
import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final

from studyapp.study.settings.study import Study
from studyapp.web.language import Language, language_of
from tests.studyapp.web.page_reader import PageReader
from tools.message_catalogues import source_texts

SPOKEN_ATTRIBUTES: Final = (
    *("alt", "aria-description", "aria-label"),
    *("aria-valuetext", "placeholder", "title"),
)
PLAYER: Final = re.compile(r"\b[A-F]\b")


class Brackets(gettext.NullTranslations):
    """Translations into a language whose words are the English ones in brackets."""

    def gettext(self, message: str) -> str:
        return f"⟦{message}⟧"

    def ngettext(self, msgid1: str, msgid2: str, n: int) -> str:
        return f"⟦{msgid1 if n == 1 else msgid2}⟧"


def bracketed() -> Language:
    """Return the language, the scripts' texts included."""
    return replace(language_of("en"), texts=Brackets(), script_texts=dict(_script_texts()))


def _script_texts() -> Iterator[tuple[str, Any]]:
    for file, _, text in source_texts():
        if isinstance(text, tuple):
            one, many = (f"⟦{form}⟧" for form in text)
            yield text[0], {"one": one, "other": many}
        elif file.endswith(".js"):
            yield text, f"⟦{text}⟧"


def left_in_english(page: PageReader, study: Study) -> str:
    """Return the words of a page that are neither bracketed nor the study's own."""
    for hidden in page.soup.select("#completion-code, meta, title"):
        hidden.clear()
    parts = [outside(page.soup.get_text(" "))]
    for tag in page.soup.find_all(True):
        parts += [outside(str(tag[name])) for name in SPOKEN_ATTRIBUTES if tag.get(name)]
    text = " ".join(" ".join(parts).split())
    own = set(_own_words(study.model_dump(exclude={"recruitment"}))) - {""}
    for words in sorted(own, key=len, reverse=True):
        text = text.replace(" ".join(words.split()), " ")
    return " ".join(re.findall(r"[^\W\d_]+", PLAYER.sub("", text)))


def outside(text: str) -> str:
    """Return what of `text` stands outside brackets."""
    left, depth = [], 0
    for letter in text:
        depth += {"⟦": 1, "⟧": -1}.get(letter, 0)
        if depth == 0 and letter != "⟧":
            left.append(letter)
    assert depth == 0, text
    return "".join(left)


def _own_words(value: Any) -> Iterator[str]:
    """Yield every text of a study's definition, without the places in it."""
    if isinstance(value, str):
        yield from value.split("{emotion}")
    elif isinstance(value, dict):
        for each in value.values():
            yield from _own_words(each)
    elif isinstance(value, list | tuple):
        for each in value:
            yield from _own_words(each)
