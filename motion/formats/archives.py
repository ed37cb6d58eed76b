"""A limit for the arrays of an ``.npz`` file: a small archive may unpack to very much."""

from __future__ import annotations

from collections.abc import Collection
from typing import Final

from numpy.lib.npyio import NpzFile

from motion.errors import InputError

LARGEST: Final = 2**30
"""Bytes of all arrays unpacked, about an hour of motion at 120 fps."""


def check_unpacked_size(archive: NpzFile, keys: Collection[str]) -> None:
    """Raise `InputError` where the arrays of `keys` would unpack to more than a motion can be."""
    names = {name for key in keys for name in (key, f"{key}.npy")}
    members = archive.zip.infolist() if archive.zip else []
    size = sum(member.file_size for member in members if member.filename in names)
    if size > LARGEST:
        raise InputError(
            f"the archive unpacks to {size / 2**20:.0f} MiB, more than {LARGEST / 2**20:.0f}",
            remedy="Cut the motion into shorter files",
        )
