"""Whether a backup can be relied on."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from motion.errors import InputError
from motion.listing import listed
from studyapp.custody.archive import REMEDY, OnFile, read_archive
from studyapp.custody.manifest import DATABASE, Manifest
from studyapp.database.copies import flaws_of_copy, rows_of_copy, schema_of_copy


def check_archive(archive: Path, on_file: OnFile) -> Manifest:
    """Check all of a backup: its files, its database, and how many rows that has.

    Raises
    ------
    InputError
        If anything is not as it was backed up.
    """
    with tempfile.TemporaryDirectory(prefix="motionjury-") as name:
        copy = Path(name) / DATABASE
        manifest = read_archive(
            archive, lambda entry: copy if entry.path == DATABASE else None, on_file
        )
        require_sound(copy, manifest, archive)
    return manifest


def require_sound(copy: Path, manifest: Manifest, archive: Path) -> None:
    """Raise `InputError` unless the database `copy` is whole and holds what `manifest` says."""
    flaws: Sequence[str] = flaws_of_copy(copy)
    if not flaws and schema_of_copy(copy) != manifest.schema_name:
        flaws = ["it has another schema"]
    if not flaws and (rows := rows_of_copy(copy)) != manifest.rows:
        tables = sorted({*rows, *manifest.rows})
        wrong = [name for name in tables if rows.get(name) != manifest.rows.get(name)]
        flaws = [f"another number of rows in {listed(wrong)}"]
    if flaws:
        raise InputError(
            f"the database in it is not what was backed up: {'; '.join(flaws[:3])}",
            where=archive,
            remedy=REMEDY,
        )
