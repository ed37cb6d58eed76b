"""Plain arrays of NumPy's files, read without unpickling.

A small archive can unpack to more than memory holds, so the unpacked size is limited.
"""

import zipfile
import zlib
from collections.abc import Collection
from pathlib import Path
from tokenize import TokenError
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError

_DAMAGE: Final = (EOFError, OSError, ValueError, OverflowError, MemoryError, TokenError)
"""Exceptions that NumPy raises on damaged files."""

LARGEST: Final = 2**30
"""Largest unpacked size of all arrays, in bytes: about an hour of motion at 120 fps."""


def load_array(path: Path) -> NDArray[Any]:
    """Return the array of the ``.npy`` file at `path`.

    Raises
    ------
    InputError
        If it is not such a file, or holds Python objects.
    """
    try:
        return np.asarray(np.load(path, allow_pickle=False))
    except _DAMAGE as error:
        raise InputError(
            "the file cannot be read as a plain array", remedy="Save it with numpy.save"
        ) from error


def load_arrays(path: Path, keys: Collection[str]) -> dict[str, NDArray[Any]]:
    """Return the arrays of the ``.npz`` file at `path` whose key is in `keys`, by key.

    Raises
    ------
    InputError
        If the file is missing, damaged, or unpacks to more than `LARGEST`, or if one of these
        arrays holds Python objects.
    """
    if not path.is_file():
        raise InputError("there is no such motion file", remedy="Check the path")
    if not zipfile.is_zipfile(path):
        raise InputError(
            "the file is not an .npz archive, or is truncated", remedy="Copy or export it again"
        )
    arrays: dict[str, NDArray[Any]] = {}
    try:
        with np.load(path, allow_pickle=False) as archive:
            present = [key for key in archive.files if key in keys]
            names = {name for key in present for name in (key, f"{key}.npy")}
            members = archive.zip.infolist()
            size = sum(member.file_size for member in members if member.filename in names)
            if size > LARGEST:
                raise InputError(
                    f"the archive unpacks to {size / 2**20:.0f} MiB, more than "
                    f"{LARGEST / 2**20:.0f}",
                    remedy="Cut the motion into shorter files",
                )
            for key in present:
                arrays[key] = np.asarray(archive[key])
    except (zipfile.BadZipFile, zlib.error, *_DAMAGE) as error:
        raise InputError(
            "the archive is damaged, or holds Python objects, which are never loaded",
            remedy="Copy or export it again, as plain numbers and texts",
        ) from error
    return arrays
