"""Bring the catalogues up to date with the texts in templates, scripts and code."""

from __future__ import annotations

import io
from typing import Final

from babel.messages.catalog import Catalog
from babel.messages.pofile import read_po, write_po

from motion.files import write_text
from studyapp.web.catalogues.extraction import catalogue_of, found_texts
from studyapp.web.language import catalogue_path

TRANSLATED: Final = ("de", "ja")
"""Languages that have a catalogue; the texts themselves are in English."""


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
    """Update every catalogue and say what is left to translate."""
    template = catalogue_of(found_texts())
    for code in TRANSLATED:
        catalogue = read_catalogue(code)
        write_text(catalogue_path(code), updated(catalogue, template))
        missing = untranslated(catalogue)
        print(f"{code}: {len(template)} texts, {len(missing)} without a translation")
        for text in missing:
            print(f"  {text}")


if __name__ == "__main__":
    main()
