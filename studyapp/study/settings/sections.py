"""What all sections of a study file have in common, and sentences of what is wrong in one."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from typing import Annotated, Any, Final, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError

Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,99}$")]


class Section(BaseModel):
    """A part of a study file: unknown keys are errors, and nothing changes once it is read."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


WORDS: Final = {
    "extra_forbidden": "unknown key",
    "missing": "is missing",
    "string_pattern_mismatch": "may hold only letters, digits, '_', '-' and '.', and must start "
    "with a letter or digit",
    "string_type": "must be a text in quotes",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "float_type": "must be a number",
    "union_tag_not_found": "'rule' is missing",
    "model_attributes_type": "must be a table of keys and values",
}
"""What the kinds of finding mean in a study file; pydantic's own words serve for the rest."""


def explain(error: ValidationError, section: type[BaseModel] | None = None, text: str = "") -> str:
    """Return every finding of `error` as ``key: what is wrong``, joined into one sentence.

    An unknown key is told with the nearest one that `section` knows in its place, and with its
    line in `text` where no other line has such a key.
    """
    found = error.errors(include_url=False)
    findings = []
    for finding in found:
        if finding["type"] == "too_short" and any(_lies_within(f, finding) for f in found):
            # Too few entries are left because others were wrong, which is said already.
            continue
        key = ".".join(str(part) for part in finding["loc"] if part != "[key]")
        message = WORDS.get(finding["type"], finding["msg"].removeprefix("Value error, "))
        if finding["type"] == "union_tag_invalid":
            tag, known = finding["ctx"]["tag"], finding["ctx"]["expected_tags"]
            message = f"unknown rule {tag!r} (use one of {known})"
        if finding["type"] == "extra_forbidden":
            *place, last = finding["loc"]
            message += _line_of(str(last), text)
            if near := get_close_matches(str(last), _known_keys(section, place), n=1):
                message += f" (did you mean {near[0]!r}?)"
        findings.append(f"{key}: {message}" if key else message)
    return "; ".join(findings)


def _lies_within(finding: Any, outer: Any) -> bool:
    """Tell whether `finding` is about a part of what `outer` is about."""
    depth = len(outer["loc"])
    return len(finding["loc"]) > depth and finding["loc"][:depth] == outer["loc"]


def _line_of(key: str, text: str) -> str:
    """Say in which line of a TOML file a key stands; nothing where that is in doubt."""
    written = re.compile(rf"""^\s*(\[+\s*([\w.-]+\.)?)?["']?{re.escape(key)}["']?\s*(=|\]|\.)""")
    lines = [number for number, line in enumerate(text.splitlines(), 1) if written.match(line)]
    return f" in line {lines[0]}" if len(lines) == 1 else ""


def _known_keys(section: type[BaseModel] | None, place: Sequence[object]) -> list[str]:
    """Return the keys that may stand at a place below a section."""
    sections = [] if section is None else [section]
    for step in place:
        fields = [one.model_fields[step] for one in sections if step in one.model_fields]
        if fields:
            sections = [one for field in fields for one in _sections_in(field.annotation)]
    return sorted({name for one in sections for name in one.model_fields})


def _sections_in(annotation: object) -> Iterator[type[BaseModel]]:
    """Yield the sections that a field may hold, alone, in a list or by name."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _sections_in(part)
