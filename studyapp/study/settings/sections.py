"""What all sections of a study file have in common, and sentences of what is wrong in one."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from typing import Annotated, Any, Final, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError

Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,99}$")]


class Section(BaseModel):
    """A part of a study file: unknown keys are errors, and nothing changes once it is read."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


MESSAGES: Final = {
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


def explain_errors(
    error: ValidationError, section: type[BaseModel] | None = None, text: str = ""
) -> str:
    """Return every finding of `error` as ``key: what is wrong``, joined into one sentence.

    Each is told with its line in `text`, an unknown key with the nearest one that `section` knows
    in its place too.
    """
    lines = _lines(text)
    found = error.errors(include_url=False)
    findings = []
    for finding in found:
        if finding["type"] == "too_short" and any(_lies_within(f, finding) for f in found):
            # Too few entries are left because others were wrong, which is said already.
            continue
        key = ".".join(str(part) for part in finding["loc"] if part != "[key]")
        message = MESSAGES.get(finding["type"], finding["msg"].removeprefix("Value error, "))
        if finding["type"] == "union_tag_invalid":
            tag, known = finding["ctx"]["tag"], finding["ctx"]["expected_tags"]
            message = f"unknown rule {tag!r} (use one of {known})"
        if line := _line_of(finding["loc"], lines):
            is_unknown = finding["type"] == "extra_forbidden"
            message += f" in line {line}" if is_unknown else f" (line {line})"
        if finding["type"] == "extra_forbidden":
            *place, last = finding["loc"]
            if near := get_close_matches(str(last), _known_keys(section, place), n=1):
                message += f" (did you mean {near[0]!r}?)"
        findings.append(f"{key}: {message}" if key else message)
    return "; ".join(findings)


def _lies_within(finding: Any, outer: Any) -> bool:
    """Tell whether `finding` is about a part of what `outer` is about."""
    depth = len(outer["loc"])
    return len(finding["loc"]) > depth and finding["loc"][:depth] == outer["loc"]


Location = tuple[str | int, ...]

_HEADING: Final = re.compile(r"\s*\[(\[?)\s*([^\]]+?)\s*\]")
_NAMED: Final = r"""(?:[\w-]+|"[^"]*"|'[^']*')"""
_PART: Final = re.compile(_NAMED)
_KEY: Final = re.compile(rf"\s*({_NAMED}(?:\s*\.\s*{_NAMED})*)\s*=")
_LONG_TEXT: Final = re.compile(r'"""|\'\'\'')


def _lines(text: str) -> dict[Location, int]:
    """Return in which line of a TOML file each table and each key begins."""
    found: dict[Location, int] = {}
    table: Location = ()
    count: Counter[Location] = Counter()
    is_in_text = False
    for number, line in enumerate(text.split("\n"), 1):
        begins_in_text = is_in_text
        is_in_text ^= len(_LONG_TEXT.findall(line)) % 2 == 1
        if begins_in_text:
            continue
        if heading := _HEADING.match(line):
            table = _parts(heading[2])
            if heading[1]:
                count[table] += 1
                table += (count[table] - 1,)
            found.setdefault(table, number)
        elif key := _KEY.match(line):
            found.setdefault(table + _parts(key[1]), number)
    return found


def _parts(dotted: str) -> Location:
    return tuple(part.strip("\"'") for part in _PART.findall(dotted))


def _line_of(location: Sequence[str | int], lines: Mapping[Location, int]) -> int | None:
    """Return the line of what is at `location`, or of the nearest thing that it is within."""
    for depth in range(len(location), 0, -1):
        if (line := lines.get(tuple(location[:depth]))) is not None:
            return line
    return None


def _known_keys(section: type[BaseModel] | None, place: Sequence[object]) -> list[str]:
    """Return the keys that may stand at a place below a section."""
    sections = [] if section is None else [section]
    for step in place:
        fields = [each.model_fields[step] for each in sections if step in each.model_fields]
        if fields:
            sections = [each for field in fields for each in _sections_in(field.annotation)]
    return sorted({name for each in sections for name in each.model_fields})


def _sections_in(annotation: object) -> Iterator[type[BaseModel]]:
    """Yield the sections that a field may hold, alone, in a list or by name."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _sections_in(part)
