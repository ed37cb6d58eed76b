"""An exclusion rule written in one word, as on the command line."""

from __future__ import annotations

import re
from typing import Final

from pydantic import TypeAdapter, ValidationError

from motion.errors import InputError
from studyapp.study.settings.exclusions import SECTIONS, Exclusion, ExclusionSection
from studyapp.study.settings.validation import explain

_ADAPTER: Final[TypeAdapter[ExclusionSection]] = TypeAdapter(Exclusion)

_RULE: Final = re.compile(r"\s*(?P<name>[A-Za-z_-]+)\s*(?:(?P<sign>[<>]=?)\s*(?P<number>\S+))?\s*")

_SETTING: Final = re.compile(r"\s*(?P<key>[a-z_]+)\s*=\s*(?P<number>\S+)\s*")


def read_exclusion(text: str, *, where: object) -> ExclusionSection:
    """Return the rule that is written in one word.

    Parameters
    ----------
    text : str
        Such as ``coverage<0.9``, or with further settings ``time<3,share=0.25``; what
        `ExclusionSection.written` returns.
    where : object
        What an error names.

    Raises
    ------
    InputError
        If there is no such rule, or it is not written like that.
    """
    word, *settings = text.split(",")
    head = _RULE.fullmatch(word)
    name = "" if head is None else head["name"].replace("-", "_")
    section = next((one for one in SECTIONS if _name(one) == name), None)
    if head is None or section is None:
        raise InputError(
            f"{text!r} is not an exclusion rule",
            where=where,
            remedy=f"Write one of {', '.join(map(_example, SECTIONS))}",
        )
    if head["sign"] != (section.limit[0] if section.limit else None):
        raise InputError(
            f"{text!r} is not how the rule {name!r} is written",
            where=where,
            remedy=f"Write {_example(section)}",
        )
    found: dict[str, object] = {"rule": name}
    if section.limit:
        found[section.limit[1]] = _number(head["number"])
    for setting in settings:
        parts = _SETTING.fullmatch(setting)
        if parts is None:
            raise InputError(
                f"{setting.strip()!r} in {text!r} is not KEY=NUMBER",
                where=where,
                remedy="Write further settings behind commas, such as time<3,share=0.25",
            )
        found[parts["key"]] = _number(parts["number"])
    try:
        return _ADAPTER.validate_python(found)
    except ValidationError as error:
        wrong = explain(error).replace(f"{name}.", "")
        raise InputError(f"{text!r}: {wrong}", where=where, remedy="Correct the rule") from None


def _name(section: type[ExclusionSection]) -> str:
    return str(section.model_fields["rule"].default)


def _example(section: type[ExclusionSection]) -> str:
    return _name(section) + (f"{section.limit[0]}NUMBER" if section.limit else "")


def _number(text: str) -> object:
    """Return a number as TOML would read it, else the text, which the rule's key refuses."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
