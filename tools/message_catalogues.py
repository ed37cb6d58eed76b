"""Keeps the translations complete: ``make messages`` finds every text that participants read."""

import ast
import io
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final, NamedTuple

from babel.messages.catalog import Catalog
from babel.messages.extract import extract_from_file
from babel.messages.pofile import read_po, write_po

from motion.files import write_text
from studyapp.session import refusal
from studyapp.session.refusal import RefusalError
from studyapp.web.language import catalogue_path

ROOT: Final = Path(__file__).parents[1]
TRANSLATED: Final = ("de", "ja")
"""Languages with a catalogue; the texts themselves are in English."""

ROOMS: Final = ("study", "session", "recruitment", "web")
"""Rooms of ``studyapp`` with texts for participants."""

PLURAL: Final = frozenset({"ngettext"})
SINGLE: Final = frozenset({"_", "Message"})
REFUSALS: Final = frozenset(
    name
    for name, kind in vars(refusal).items()
    if isinstance(kind, type) and issubclass(kind, RefusalError)
)
TEMPLATE_OPTIONS: Final = {"newstyle_gettext": "true", "trimmed": "true", "silent": "false"}
SCRIPT_CALLS: Final = {"say": None, "sayCount": (1, 2)}


class SourceText(NamedTuple):
    """A text and its position.

    Attributes
    ----------
    file : str
        Path from the repository's root.
    text : str or (str, str)
        The text, or the forms for one and for many.
    """

    file: str
    line: int
    text: str | tuple[str, ...]


def source_texts() -> Iterator[SourceText]:
    """Yield every text for participants, file by file.

    Raises
    ------
    ValueError
        If a call with a text for participants does not give it as a literal.
    """
    web = ROOT / "studyapp" / "web"
    for room in ROOMS:
        for path in sorted((ROOT / "studyapp" / room).rglob("*.py")):
            yield from texts_of_code(path)
    for path in sorted((web / "templates").rglob("*.html")):
        yield from _extracted(path, "jinja2.ext:babel_extract", {"_": None, "ngettext": (1, 2)})
    for path in sorted((web / "static").rglob("*.js")):
        yield from _extracted(path, "javascript", SCRIPT_CALLS)


def catalogue_of(texts: Iterable[SourceText]) -> Catalog:
    """Return a catalogue without translations."""
    catalogue = Catalog(project="Motion Jury", charset="utf-8", fuzzy=False)
    for file, _, text in texts:
        catalogue.add(text, locations=[(file, 0)])
    return catalogue


def _extracted(path: Path, method: str, calls: Mapping[str, Any]) -> Iterator[SourceText]:
    for line, text, _, _ in extract_from_file(
        method, path, keywords=calls, options=TEMPLATE_OPTIONS
    ):
        yield SourceText(_named(path), line, text)


def texts_of_code(path: Path) -> Iterator[SourceText]:
    """Yield the texts in one Python file."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.Call) or any(
            argument.arg is None for argument in node.keywords
        ):
            continue  # what is called with **values passes on what another call names
        name = getattr(node.func, "id", "")
        if name in SINGLE:
            yield SourceText(_named(path), node.lineno, _literal(path, node, 0))
        elif name in PLURAL:
            yield SourceText(
                _named(path), node.lineno, (_literal(path, node, 0), _literal(path, node, 1))
            )
        elif name in REFUSALS:
            for place in (0, 1):
                yield SourceText(_named(path), node.lineno, _literal(path, node, place))


def _literal(path: Path, call: ast.Call, place: int) -> str:
    """Return the text given at `place` of `call`."""
    argument = call.args[place] if place < len(call.args) else None
    if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
        return argument.value
    raise ValueError(
        f"{_named(path)}:{call.lineno}: the text {place + 1} of this call is not a literal, "
        "so it cannot be found and translated"
    )


def _named(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def updated(catalogue: Catalog, template: Catalog) -> str:
    """Return the file of `catalogue` with the texts of `template`, no others, in their order."""
    catalogue.update(template, no_fuzzy_matching=True, update_creation_date=False)
    written = io.BytesIO()
    write_po(written, catalogue, width=100, ignore_obsolete=True, include_lineno=False)
    return written.getvalue().decode("utf-8")


def untranslated(catalogue: Catalog) -> list[str]:
    """Return the texts of `catalogue` that have no translation yet."""
    missing = []
    for message in catalogue:
        forms = message.string if isinstance(message.string, tuple) else (message.string,)
        if message.id and not all(forms):
            missing.append(message.id if isinstance(message.id, str) else message.id[0])
    return missing


def read_catalogue(code: str) -> Catalog:
    """Return the translations into `code`."""
    with catalogue_path(code).open("rb") as file:
        return read_po(file, locale=code)


def main() -> None:
    """Update every catalogue and list untranslated texts."""
    template = catalogue_of(source_texts())
    for code in TRANSLATED:
        catalogue = read_catalogue(code)
        write_text(catalogue_path(code), updated(catalogue, template))
        missing = untranslated(catalogue)
        print(f"{code}: {len(template)} texts, {len(missing)} without a translation")
        for text in missing:
            print(f"  {text}")


if __name__ == "__main__":
    main()
