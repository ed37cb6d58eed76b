"""What the files of a take hold, told by hashes that are computed once."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Self

from pydantic import BaseModel, TypeAdapter, ValidationError

from motion.errors import InputError
from motion.files import write_text


class FileState(BaseModel, frozen=True):
    """A file that was hashed, and how to tell that it has not been written since.

    Attributes
    ----------
    size, mtime_ns : int
        Bytes, and when it was last written, in nanoseconds.
    sha256 : str
        Hash of its content.
    """

    size: int
    mtime_ns: int
    sha256: str

    @classmethod
    def of(cls, path: Path, known: FileState | None = None) -> Self:
        """Return the state of `path`; its content is read only if it is not as `known`."""
        facts = path.stat()
        same = known is not None and (known.size, known.mtime_ns) == (
            facts.st_size,
            facts.st_mtime_ns,
        )
        if known is not None and same:
            return cls.model_validate(known.model_dump())
        with path.open("rb") as file:
            sha256 = hashlib.file_digest(file, "sha256").hexdigest()
        return cls(size=facts.st_size, mtime_ns=facts.st_mtime_ns, sha256=sha256)


_STATES = TypeAdapter(dict[str, FileState])


def hashes_of(files: tuple[Path, ...], memory: Path) -> tuple[str, ...]:
    """Return the sha256 of each of `files`.

    Parameters
    ----------
    files : tuple of Path
        The files.
    memory : Path
        JSON file in which hashes are kept, so that files which were not written since are not
        read again. It may be missing or damaged.

    Raises
    ------
    InputError
        If a file cannot be read.
    """
    try:
        known = _STATES.validate_json(memory.read_bytes())
    except (OSError, ValidationError):
        known = {}
    states: dict[str, FileState] = {}
    for path in files:
        place = str(path.absolute())
        try:
            states[place] = FileState.of(path, known.get(place))
        except OSError as error:
            raise InputError(
                f"the file cannot be read ({error.strerror})",
                where=path,
                remedy="Check that it is there and may be read",
            ) from error
    if states != known:
        plain = {place: state.model_dump() for place, state in states.items()}
        write_text(memory, json.dumps(plain, indent=1))
    return tuple(states[str(path.absolute())].sha256 for path in files)
