"""Opening the ``.npz`` file of a body: nothing in it is run, and damage is told as such."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.lib.npyio import NpzFile

from motion.errors import InputError


@contextmanager
def body_archive(path: Path) -> Iterator[NpzFile]:
    """Give the arrays of a body model by name; each is read when it is asked for.

    Raises
    ------
    InputError
        If the file is missing or no such archive, or an array asked for in the block is damaged
        or would run code.
    """
    if not path.is_file():
        raise InputError(
            "there is no such body model", where=path, remedy="Give the path of an SMPL-X .npz file"
        )
    try:
        with path.open("rb") as file:
            content = np.load(file, allow_pickle=False)
            if not isinstance(content, NpzFile):
                raise ValueError("a single array")
            with content as archive:
                yield archive
    except (ValueError, OSError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise InputError(
            "the file cannot be read as a body model: it is not a NumPy archive, or damaged",
            where=path,
            remedy="Give an SMPL-X model in .npz format; convert a .pkl with the smplx tools",
        ) from error
