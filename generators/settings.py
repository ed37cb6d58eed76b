"""Settings of generators, such as those of a study's condition; loads no network."""

from functools import reduce
from operator import or_
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, Final, Self, get_args, get_type_hints

from pydantic import BaseModel, BeforeValidator, ConfigDict

from motion.errors import InputError
from motion.files import sha256_of


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

    def resolved_in(self, folder: Path) -> Self:
        """Return the settings with paths resolved in `folder`.

        Raises
        ------
        InputError
            If a file or folder is missing.
        """
        values = {name: getattr(self, name) for name in type(self).model_fields}
        for key, kind in types_of(type(self)).items():
            value = values[key]
            if value is None or kind not in _ON_DISK:
                continue
            if kind == NameOrFile and not Path(value).suffix:
                continue
            path = values[key] = folder / value
            if not (path.is_dir() if kind == Folder else path.is_file()):
                role = _ON_DISK[kind].format(key)
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


def types_of(kind: type[Settings]) -> dict[str, Any]:
    """Return the type of each setting's values other than None."""
    hints, types = get_type_hints(kind, include_extras=True), {}
    for key in kind.model_fields:
        parts = [part for part in get_args(hints[key]) if part is not NoneType]
        types[key] = reduce(or_, parts) if NoneType in get_args(hints[key]) else hints[key]
    return types
