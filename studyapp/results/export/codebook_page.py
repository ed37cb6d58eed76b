"""The codebook as a page of Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

INTRODUCTION: Final = """\
Every column of every table, what its values mean, and when a cell is empty. In CSV an empty cell
is a missing value (in TSV it says `n/a`), truth is `true` or `false`, and a moment is ISO 8601 in
UTC. Text that a spreadsheet would run as a formula has an apostrophe before it; take it away to
get the text as it was given. Parquet has types instead, null for what is missing, and no
apostrophes.

**Free text** was written by people and may name somebody: read it before you pass it on.
"""


def codebook_page(book: Mapping[str, Any]) -> str:
    """Return the page of a codebook (see `studyapp.results.export.codebook`)."""
    return "\n".join(_lines(book)) + "\n"


def _lines(book: Mapping[str, Any]) -> Iterator[str]:
    study = book["study"]
    yield f"# Codebook of {_plain(study['title'])}"
    yield ""
    yield (
        f"Study `{study['name']}`, protocol {study['protocol']}, seed {study['seed']}, SHA-256 of "
        f"`study.toml` `{study['sha256']}`, written by Motion Jury {book['motionjury']}."
    )
    yield ""
    yield INTRODUCTION
    for table in book["tables"]:
        yield from _table(table)
    yield "## Questions of the trials"
    yield ""
    for question in book["questions"]:
        asked = f", asked in {', '.join(question['parts'])}" if question["parts"] else ""
        title = f"{_plain(question['title'])}{asked}"
        yield f"**`{question['name']}`** ({title}): {_plain(question['text'])}"
        yield ""
        yield from _values(("value", "meaning"), question["values"])
        yield from _values(("reason", "wording"), question["reasons"])
    if book["form"]:
        yield "## Questions about the participant"
        yield ""
    for question in book["form"]:
        free = "; **free text**" if question["free_text"] else ""
        must = "must be answered" if question["required"] else "may be left open"
        yield (
            f"**`{question['name']}`** ({question['stage']}, {question['kind']}, {must}{free}): "
            f"{_plain(question['text'])}"
        )
        yield ""
        yield from _values(("value", "meaning"), question["values"])


def _table(table: Mapping[str, Any]) -> Iterator[str]:
    yield f"## {str(table['name']).capitalize().replace('_', ' ')}"
    yield ""
    yield f"{', '.join(f'`{file}`' for file in table['files'])}: {table['row']}"
    yield ""
    yield from _rows(
        ("column", "type", "unit", "meaning", "empty where"),
        [
            (
                f"`{column['name']}`",
                column["type"],
                column["unit"],
                column["meaning"] + (" **Free text.**" if column["free_text"] else ""),
                column["missing"] or "never",
            )
            for column in table["columns"]
        ],
    )
    for column in table["columns"]:
        if column["values"]:
            yield f"Values of `{column['name']}`:"
            yield ""
            yield from _values(("value", "meaning"), column["values"])


def _values(header: tuple[str, str], values: Mapping[str, str]) -> Iterator[str]:
    if values:
        yield from _rows(header, [(f"`{value}`", label) for value, label in values.items()])


def _rows(header: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    yield "| " + " | ".join(header) + " |"
    yield "|" + "---|" * len(header)
    for row in rows:
        yield "| " + " | ".join(_plain(cell) for cell in row) + " |"
    yield ""


def _plain(text: str) -> str:
    """Return text that stays within its line and its cell, and opens no markup of its own."""
    return " ".join(str(text).split()).replace("|", "\\|").replace("<", "&lt;")
