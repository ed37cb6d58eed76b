"""Settings of generators, such as those of a study's condition; loads no network."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import reduce
from operator import or_
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, Final, Self, get_args, get_type_hints

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    ValidationError,
    ValidationInfo,
    model_validator,
)
from pydantic_core import InitErrorDetails, PydanticCustomError

from motion.errors import InputError, listed
from motion.files import sha256_of


@dataclass(frozen=True, kw_only=True)
class Reader:
    """The context in which settings are validated.

    Attributes
    ----------
    generator : str
        Name of the generator.
    sibling_keys : tuple of str
        Other keys of the same table, for suggestions when a key is misspelt.
    """

    generator: str = ""
    sibling_keys: tuple[str, ...] = ()

    def unknown(self, key: str, known: Sequence[str]) -> str:
        """Return the error for an unknown key."""
        close_matches = get_close_matches(key, [*known, *self.sibling_keys], n=1)
        if close_matches:
            return f"unknown key (did you mean {close_matches[0]!r}?)"
        if not known:
            return f"{key} is given, but nothing there uses it"
        return f"unknown key (known are {listed(known)})"


def _path(value: object) -> Path:
    if not isinstance(value, str | Path) or not str(value):
        raise ValueError("must be a path in quotes")
    return Path(value)


File = Annotated[Path, BeforeValidator(_path), "file"]
"""A file, relative to the study's folder."""

Folder = Annotated[Path, BeforeValidator(_path), "folder"]
"""A folder, relative to the study's folder."""

NameOrFile = Annotated[str | Path, "name or file"]
"""The name of a learned emotion or speaker, or a recording, which has a suffix."""

_ON_DISK: Final = {File: "{}", Folder: "folder of {}", NameOrFile: "recording of {}"}
"""Types of keys whose values are on the disk, and how errors call them."""


class Settings(BaseModel):
    """Settings of a generator: its keys in a condition, and its command-line options.

    Each key has a type, a default unless it is required, and a description.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    @model_validator(mode="before")
    @classmethod
    def _check_keys(cls, values: Any, info: ValidationInfo) -> Any:
        """Refuse unknown keys, with suggestions, and missing ones."""
        reader: Reader = info.context or Reader()
        known = cls.model_fields
        if not isinstance(values, Mapping):
            return values
        wrong = [(key, reader.unknown(key, list(known))) for key in values if key not in known]
        wrong += [
            (
                key,
                f"generator {reader.generator!r} needs a {key}"
                if reader.generator
                else "is missing",
            )
            for key, field in known.items()
            if field.is_required() and key not in values
        ]
        if wrong:
            raise ValidationError.from_exception_data(
                cls.__name__,
                [
                    InitErrorDetails(
                        type=PydanticCustomError("wrong_key", "{what}", {"what": problem}),
                        loc=(key,),
                        input=values.get(key),
                    )
                    for key, problem in wrong
                ],
            )
        return values

    def resolved_in(self, folder: Path) -> Self:
        """Return the settings with paths resolved in `folder`.

        Raises
        ------
        InputError
            If a file or folder is missing.
        """
        values = {name: getattr(self, name) for name in type(self).model_fields}
        for setting in settings_of(type(self)):
            value, kind = values[setting.key], setting.type
            if value is None or kind not in _ON_DISK:
                continue
            if kind == NameOrFile and not Path(value).suffix:
                continue
            path = values[setting.key] = folder / value
            if not (path.is_dir() if kind == Folder else path.is_file()):
                role = _ON_DISK[kind].format(setting.key)
                raise InputError(f"there is no such {role}", where=path, remedy="Check the path")
        return type(self).model_validate(values)

    def fingerprint(self) -> tuple[object, ...]:
        """Return a fingerprint of all values, with files' contents in place of their paths."""
        return tuple((name, content(getattr(self, name))) for name in type(self).model_fields)


def content(value: object) -> object:
    """Return a value's part of a fingerprint: a file's hash, or the hashes of a folder's files."""
    if not isinstance(value, Path):
        return value
    if value.is_dir():
        files = (path for path in sorted(value.rglob("*")) if path.is_file())
        return tuple((path.name, content(path)) for path in files)
    return sha256_of(value)


@dataclass(frozen=True, kw_only=True)
class Setting:
    """One key of `Settings`.

    Attributes
    ----------
    key : str
        The key in a condition; on the command line an option.
    type : type
        The type of its values other than None.
    description : str
        Description for the command's help.
    required : bool
        Whether it must be given.
    """

    key: str
    type: Any
    description: str
    required: bool


def settings_of(kind: type[Settings]) -> Iterator[Setting]:
    """Yield the settings of a generator."""
    hints = get_type_hints(kind, include_extras=True)
    for key, field in kind.model_fields.items():
        types = [part for part in get_args(hints[key]) if part is not NoneType]
        yield Setting(
            key=key,
            type=reduce(or_, types) if NoneType in get_args(hints[key]) else hints[key],
            description=field.description or "",
            required=field.is_required(),
        )
