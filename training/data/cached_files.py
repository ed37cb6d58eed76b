"""Hashes of files, computed once, and memory-mapped arrays that are known to be intact."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np
import pyarrow
from numpy.typing import NDArray
from pydantic import BaseModel, TypeAdapter, ValidationError

from motion.errors import InputError
from motion.files import replacing, sha256_of, write_text


class FileState(BaseModel, frozen=True):
    """The hash of a file, and its size and time of writing, which show whether it still holds.

    Attributes
    ----------
    size, mtime_ns : int
        Bytes, and the time of the last write in nanoseconds.
    sha256 : str
        Hash of its content.
    """

    size: int
    mtime_ns: int
    sha256: str

    @classmethod
    def of(cls, path: Path, known: FileState | None = None) -> Self:
        """Return the state of `path`; it is read only if size or time differ from `known`."""
        status = path.stat()
        unchanged = known is not None and (known.size, known.mtime_ns) == (
            status.st_size,
            status.st_mtime_ns,
        )
        if known is not None and unchanged:
            return cls.model_validate(known.model_dump())
        return cls(size=status.st_size, mtime_ns=status.st_mtime_ns, sha256=sha256_of(path))


_STATES = TypeAdapter(dict[str, FileState])


def hashes_of(files: tuple[Path, ...], memory: Path) -> tuple[str, ...]:
    """Return the sha256 of each of `files`.

    Parameters
    ----------
    files : tuple of Path
        The files.
    memory : Path
        JSON file with the hashes of earlier calls, so that unchanged files are not read again. It
        may be missing or damaged.

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
        content = {place: state.model_dump() for place, state in states.items()}
        write_text(memory, json.dumps(content, indent=1))
    return tuple(states[str(path.absolute())].sha256 for path in files)


FloatArray = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class CachedArray:
    """An array that was read from disk.

    Attributes
    ----------
    values : ndarray, shape (frames, channels), float32
        Memory-mapped and read-only.
    sha256 : str
        Hash of its file.
    """

    values: FloatArray
    sha256: str


def write_array(path: Path, values: FloatArray) -> None:
    """Write `values` to `path` (``.npy``), and a seal in its folder that shows it is intact."""
    with replacing(path) as draft:
        np.save(draft, values, allow_pickle=False)
    write_text(_seal_of(path), FileState.of(path).model_dump_json())


def open_array(path: Path) -> CachedArray | None:
    """Return the array in `path`; None if it is missing or damaged."""
    try:
        seal = FileState.model_validate_json(_seal_of(path).read_bytes())
        state = FileState.of(path, seal)
        if state.sha256 != seal.sha256:
            return None
        if state != seal:
            # A copy has the same content and another time. It need not be read again.
            write_text(_seal_of(path), state.model_dump_json())
        return CachedArray(_map_array(path), state.sha256)
    except (OSError, ValidationError, ValueError):
        return None


def content_sha256(parts: list[str]) -> str:
    """Return one hash of several texts in order."""
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _seal_of(path: Path) -> Path:
    return path.with_suffix(".json")


def _map_array(path: Path) -> FloatArray:
    """Return the array in `path`, mapped into memory.

    numpy's own mapping keeps each file open. A data set has more files than a process may open.
    """
    with path.open("rb") as file:
        version = np.lib.format.read_magic(file)
        if version != (1, 0):
            raise ValueError(f"version {version} of the file format")
        shape, fortran_order, dtype = np.lib.format.read_array_header_1_0(file)
        start = file.tell()
    if fortran_order or dtype != np.float32 or len(shape) != 2:
        raise ValueError("not an array that this module wrote")
    with pyarrow.memory_map(str(path)) as mapped:
        buffer = mapped.read_buffer()
    values = np.frombuffer(buffer, dtype=np.float32, offset=start)
    return values.reshape(shape)
