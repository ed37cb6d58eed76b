"""Removing old backups: only those that were made of the same study, by the same name."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

from motion.errors import InputError
from studyapp.stages.backing_up.archive import read_manifest
from studyapp.stages.backing_up.manifest import Manifest

STAMP: Final = "%Y%m%dT%H%M%SZ"
_STAMP: Final = r"\d{8}T\d{6}Z"


def dated_name(study: str, manifest: Manifest) -> str:
    """Return the name of a backup in a folder of backups."""
    return f"{study}-{manifest.made_at:{STAMP}}.tar.gz"


def remove_older(folder: Path, study: str, newest: Manifest, keep: int) -> list[Path]:
    """Remove the backups of one study in `folder` but for the newest `keep`, and return which.

    Left alone is whatever is no backup, is of another study, or has another name than this
    command gives.

    Parameters
    ----------
    study : str
        What names begin with.
    newest : Manifest
        Of the backup that was just made.
    """
    pattern = re.compile(rf"{re.escape(study)}-{_STAMP}\.tar\.gz")
    made = sorted(
        (
            path
            for path in folder.iterdir()
            if pattern.fullmatch(path.name)
            and not path.is_symlink()
            and path.is_file()
            and _origin(path) == newest.origin
        ),
        # The name ends in the moment it was made.
        key=lambda path: path.name,
        reverse=True,
    )
    for path in made[keep:]:
        path.unlink()
    return made[keep:]


def _origin(path: Path) -> str | None:
    try:
        return read_manifest(path).origin
    except InputError:
        return None
