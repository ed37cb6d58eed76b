"""The base of all sections of a study file, and readable messages about errors in them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from typing import Annotated, Final, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError

NAME: Final = r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,99}$"
COLOUR: Final = "^#[0-9a-fA-F]{6}$"
MAIL_ADDRESS: Final = r"^[^@\s,]+@[^@\s,]+$"
MONEY: Final = r"^(\d{1,6}(\.\d{2})?)?$"
CURRENCY: Final = r"^([A-Z]{3})?$"
CODE: Final = r"^[A-Za-z0-9_-]*$"
HOST: Final = r"^([a-z0-9-]+(\.[a-z0-9-]+)+)?$"

PATTERNS: Final = {
    NAME: "may contain only letters, digits, '_', '-' and '.', and must start with a letter or "
    "digit",
    COLOUR: 'must be a colour such as "#ececee"',
    MAIL_ADDRESS: 'must be an e-mail address such as "ada@example.org"',
    MONEY: 'must be an amount such as "2.50"',
    CURRENCY: 'must be the three letters of a currency such as "EUR"',
    CODE: "may contain only letters, digits, '_' and '-'",
    HOST: 'must be the name of a host such as "study.example.org"',
}
"""The patterns of texts, with our words for them."""

Name = Annotated[str, Field(pattern=NAME)]


class Section(BaseModel):
    """A section of a study file: unknown keys are errors, and instances are immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


MESSAGES: Final = {
    "extra_forbidden": "unknown key",
    "missing": "is missing",
    "string_type": "must be text in quotes",
    "tuple_type": "must be a list in square brackets",
    "too_short": "needs at least {min_length}, not {actual_length}",
    "too_long": "may have at most {max_length}, not {actual_length}",
    "union_tag_not_found": "'rule' is missing",
    "union_tag_invalid": "unknown rule {tag!r} (use one of {expected_tags})",
    "dict_type": "must be a table of keys and values",
    "model_type": "must be a table of keys and values",
    "model_attributes_type": "must be a table of keys and values",
}
"""Our words for some of pydantic's errors, with its values; its own serve for the others."""


def explain_errors(
    error: ValidationError, section: type[BaseModel] | None = None, text: str = ""
) -> str:
    """Return all errors as ``key: what is wrong``, joined by semicolons.

    Each names its line in `text`. Of an unknown key, it names the closest known key of `section`.
    """
    lines = lines_of(text)
    errors = error.errors(include_url=False)
    sentences = []
    for each in errors:
        kind, location = each["type"], each["loc"]
        inside = (other["loc"] for other in errors if other["loc"] != location)
        if kind == "too_short" and any(loc[: len(location)] == location for loc in inside):
            # Too few entries remain because others are wrong, which is reported anyway.
            continue
        key = ".".join(str(part) for part in location if part != "[key]")
        context = each.get("ctx", {})
        if kind in MESSAGES:
            message = MESSAGES[kind].format(**context)
        else:
            own_words = each["msg"].removeprefix("Value error, ").replace("Input should", "must")
            message = PATTERNS.get(context.get("pattern", ""), own_words)
        line = _line_of(location, lines)
        if kind == "extra_forbidden":
            message += f" in line {line}" if line else ""
            *path, last = location
            if matches := get_close_matches(str(last), _known_keys(section, path), n=1):
                message += f" (did you mean {matches[0]!r}?)"
        elif line:
            message += f" (line {line})"
        elif kind == "value_error":
            message = "; ".join(with_line(part, lines) for part in message.split("; "))
        sentences.append(f"{key}: {message}" if key else message)
    return "; ".join(sentences)


def with_line(contradiction: str, lines: Mapping[Location, int]) -> str:
    """Return what contradicts another key, with the line of the key it begins with, if any."""
    key = re.match(r"[\w.-]*", contradiction)
    line = _line_of(key[0].split("."), lines) if key else None
    return f"{contradiction} (line {line})" if line else contradiction


Location = tuple[str | int, ...]


_HEADING: Final = re.compile(r"\s*\[(\[?)\s*([^\]]+?)\s*\]")
_NAMED: Final = r"""(?:[\w-]+|"[^"]*"|'[^']*')"""
_PART: Final = re.compile(_NAMED)
_KEY: Final = re.compile(rf"\s*({_NAMED}(?:\s*\.\s*{_NAMED})*)\s*=")
_LONG_TEXT: Final = re.compile(r'"""|\'\'\'')


def lines_of(text: str) -> dict[Location, int]:
    """Return the line of a TOML file in which each table and each key begins."""
    lines: dict[Location, int] = {}
    table: Location = ()
    count: Counter[Location] = Counter()
    is_in_text = False
    for number, line in enumerate(text.split("\n"), 1):
        starts_in_text = is_in_text
        is_in_text ^= len(_LONG_TEXT.findall(line)) % 2 == 1
        if starts_in_text:
            continue
        if heading := _HEADING.match(line):
            table = _parts(heading[2])
            if heading[1]:
                count[table] += 1
                table += (count[table] - 1,)
            lines.setdefault(table, number)
        elif key := _KEY.match(line):
            lines.setdefault(table + _parts(key[1]), number)
    return lines


def _parts(dotted: str) -> Location:
    return tuple(part.strip("\"'") for part in _PART.findall(dotted))


def _line_of(location: Sequence[str | int], lines: Mapping[Location, int]) -> int | None:
    """Return the line of `location`, or of the nearest table that contains it."""
    for depth in range(len(location), 0, -1):
        if (line := lines.get(tuple(location[:depth]))) is not None:
            return line
    return None


def _known_keys(section: type[BaseModel] | None, path: Sequence[object]) -> list[str]:
    """Return the keys that are allowed at `path` below `section`."""
    sections = [] if section is None else [section]
    for step in path:
        fields = [each.model_fields[step] for each in sections if step in each.model_fields]
        if fields:
            sections = [each for field in fields for each in _sections_in(field.annotation)]
    return sorted({name for each in sections for name in each.model_fields})


def _sections_in(annotation: object) -> Iterator[type[BaseModel]]:
    """Yield the sections in a field's annotation, however nested."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _sections_in(part)
