"""Arrays on disk that are read as if they were in memory, and known to be whole."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow
from numpy.typing import NDArray
from pydantic import ValidationError

from motion.files import replacing, write_text
from training.data.source_files import FileState

FloatArray = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class KeptArray:
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
    """Write `values` to `path` (``.npy``), and beside it what tells that the file is whole."""
    with replacing(path) as draft:
        np.save(draft, values, allow_pickle=False)
    write_text(_seal_of(path), FileState.of(path).model_dump_json())


def open_array(path: Path) -> KeptArray | None:
    """Return the array in `path`, or None where there is none, or not as it was written."""
    try:
        seal = FileState.model_validate_json(_seal_of(path).read_bytes())
        state = FileState.of(path, seal)
        if state.sha256 != seal.sha256:
            return None
        if state != seal:
            # A copy: the same content, written at another time. It need not be read again.
            write_text(_seal_of(path), state.model_dump_json())
        return KeptArray(_mapped(path), state.sha256)
    except (OSError, ValidationError, ValueError):
        return None


def content_sha256(parts: list[str]) -> str:
    """Return one hash of several texts in order."""
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _seal_of(path: Path) -> Path:
    return path.with_suffix(".json")


def _mapped(path: Path) -> FloatArray:
    """Return the array in `path`, mapped into memory.

    numpy's own mapping keeps each file open, of which a process may have about a thousand; a data
    set has more.
    """
    with path.open("rb") as file:
        version = np.lib.format.read_magic(file)
        if version != (1, 0):
            raise ValueError(f"version {version} of the file format")
        shape, fortran_order, dtype = np.lib.format.read_array_header_1_0(file)
        start = file.tell()
    if fortran_order or dtype != np.float32 or len(shape) != 2:
        raise ValueError("not an array as it is written here")
    with pyarrow.memory_map(str(path)) as mapped:
        buffer = mapped.read_buffer()
    values = np.frombuffer(buffer, dtype=np.float32, offset=start)
    return values.reshape(shape)
