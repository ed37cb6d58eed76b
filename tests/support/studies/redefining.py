"""Changing a study file in a test."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import tomlkit


def redefine(study: Path, *changes: tuple[str, str], added: str = "") -> None:
    """Change the study file in the folder `study`.

    Parameters
    ----------
    changes : tuple of str and str
        Old and new text.
    added : str
        Text to append.
    """
    definition = study / "study.toml"
    text = definition.read_text("utf-8")
    for old, new in changes:
        assert old in text, f"the study file does not contain {old!r}"
        text = text.replace(old, new)
    definition.write_text(text + added, "utf-8")


def set_keys(definition: Path, keys: Mapping[str, object]) -> None:
    """Set keys of a study file, such as ``video.size`` or ``questions.0.text``."""
    with edited(definition) as document:
        for key, value in keys.items():
            *tables, name = key.split(".")
            table: Any = document
            for each in tables:
                table = table[int(each)] if each.isdigit() else table.setdefault(each, {})
            table[name] = value


@contextmanager
def edited(definition: Path) -> Iterator[tomlkit.TOMLDocument]:
    """Give the keys of a study file, and write them back at the end of the block."""
    document = tomlkit.parse(definition.read_text("utf-8"))
    yield document
    definition.write_text(tomlkit.dumps(document), "utf-8")
