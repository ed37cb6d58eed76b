"""Changing a study file in a test."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import tomlkit


@contextmanager
def edited(definition: Path) -> Iterator[tomlkit.TOMLDocument]:
    """Give the keys of a study file, and write them back at the end of the block."""
    document = tomlkit.parse(definition.read_text("utf-8"))
    yield document
    definition.write_text(tomlkit.dumps(document), "utf-8")
