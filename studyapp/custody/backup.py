"""Backing up a study into one file, while it may be served; and checking a backup."""

from __future__ import annotations

import hashlib
import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Final

from motion.errors import InputError, listed
from studyapp.clock import Clock
from studyapp.custody.archive import (
    ENDINGS,
    REMEDY,
    is_compressed,
    read_archive,
    read_manifest,
    write_archive,
)
from studyapp.custody.manifest import (
    DATABASE,
    Manifest,
    OnFile,
    found_file,
    media_files,
    small_files,
)
from studyapp.database.copies import count_rows, find_flaws, schema_of_copy, write_copy
from studyapp.database.engine import database_url_of, display_address
from studyapp.study.folder import StudyFolder

_UNFINISHED: Final = "unfinished-backup-"


@dataclass(frozen=True, kw_only=True)
class Backup:
    """A backup that was made.

    Attributes
    ----------
    path : Path
        Its file.
    manifest : Manifest
        What is in it.
    database : str
        The address of what was backed up, without a password.
    removed : tuple of Path
        Older backups that were removed.
    """

    path: Path
    manifest: Manifest
    database: str
    removed: tuple[Path, ...] = ()


def back_up(
    folder: StudyFolder,
    out: Path,
    clock: Clock,
    *,
    media: bool = False,
    keep: int | None = None,
    on_file: OnFile = lambda _done, _total: None,
) -> Backup:
    """Back up the study in `folder`, its database included, into one file.

    It appears under its name only when it is whole and on disk, for its owner alone. Every answer
    that was acknowledged before the call is in it.

    Parameters
    ----------
    out : Path
        The file, which must not exist; or a folder, where it is named after the study and the
        moment.
    media : bool
        Whether speech, motion and videos go into it; else only what they are, so that restoring
        can tell whether they are there.
    keep : int, optional
        With a folder: only so many backups of this study stay there. The new one is checked first.
    on_file : callable
        Is told how many files are done, of how many.

    Raises
    ------
    InputError
        If there is no database, `out` cannot be written, or a file changes meanwhile.
    """
    into_folder = out.is_dir()
    _require_room_for_name(out, into_folder=into_folder)
    if keep is not None and not into_folder:
        raise InputError(
            "only a folder has older backups to be removed",
            where=out,
            remedy="Give an existing folder with --keep",
        )
    made_at = clock.now()
    url = database_url_of(folder.root)
    with _work_folder(out if into_folder else out.parent) as work:
        copy = work / DATABASE
        write_copy(url, copy)
        taken = [*small_files(folder), found_file(copy, DATABASE)]
        known = media_files(folder, on_file)
        if media:
            taken += known
        manifest = Manifest(
            motionjury=metadata.version("motionjury"),
            made_at=made_at,
            origin=_origin(folder, url),
            schema_name=schema_of_copy(copy) or "",
            rows=count_rows(copy),
            files=tuple(each.entry for each in taken),
            media=() if media else tuple(each.entry for each in known),
        )
        study = folder.root.resolve().name
        path = out / dated_name(study, manifest) if into_folder else out
        draft = work / "archive"
        handle = os.open(draft, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(handle, "wb") as stream:
            write_archive(
                stream,
                manifest,
                [each.source for each in taken],
                compressed=is_compressed(path.name),
                on_file=on_file,
            )
            stream.flush()
            os.fsync(stream.fileno())
        _name(draft, path)
    removed: list[Path] = []
    if keep is not None:
        # None goes before its successor is known to be good.
        check_archive(path, on_file)
        removed = remove_older(path.parent, study, manifest, keep)
    return Backup(
        path=path, manifest=manifest, database=display_address(url), removed=tuple(removed)
    )


def _require_room_for_name(out: Path, *, into_folder: bool) -> None:
    if into_folder:
        return
    if not out.name.endswith(ENDINGS):
        raise InputError(
            "a backup is a .tar or .tar.gz",
            where=out,
            remedy="Give such a name, or a folder that exists",
        )
    if out.exists() or out.is_symlink():
        raise _taken(out)
    if not out.parent.is_dir():
        # Making it could fill a disk where another one should have been mounted.
        raise InputError(
            "the folder for the backup is not there",
            where=out.parent,
            remedy="Make it, or mount its disk",
        )


@contextmanager
def _work_folder(beside: Path) -> Iterator[Path]:
    """Give a folder that only its owner may look into, on the disk where the backup will be."""
    try:
        with tempfile.TemporaryDirectory(prefix=f".{_UNFINISHED}", dir=beside) as name:
            yield Path(name)
    except OSError as error:
        if error.filename is not None:
            raise
        raise InputError(
            f"the backup could not be written: {error.strerror or error}",
            where=beside,
            remedy="Make room; nothing was left behind",
        ) from error


def _name(draft: Path, path: Path) -> None:
    """Give the finished `draft` its name, unless something has that name, and let it last."""
    try:
        os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600))
    except FileExistsError:
        raise _taken(path) from None
    draft.replace(path)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def _taken(path: Path) -> InputError:
    return InputError(
        "there is something already, and backups never overwrite",
        where=path,
        remedy="Give another name, or a folder: there, each backup gets a name of its own",
    )


def _origin(folder: StudyFolder, url: str) -> str:
    where = f"{folder.root.resolve()}\n{display_address(url)}"
    return hashlib.sha256(where.encode()).hexdigest()


STAMP: Final = "%Y%m%dT%H%M%SZ"
_STAMP: Final = r"\d{8}T\d{6}Z"


def dated_name(study: str, manifest: Manifest) -> str:
    """Return the name of a backup in a folder of backups."""
    return f"{study}-{manifest.made_at:{STAMP}}.tar.gz"


def remove_older(folder: Path, study: str, newest: Manifest, keep: int) -> list[Path]:
    """Remove the backups of one study in `folder` but for the newest `keep`, and return which.

    Left alone is whatever is not a backup, is of another study, or has another name than this
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
            and _recorded_origin(path) == newest.origin
        ),
        # The name ends in the moment it was made.
        key=lambda path: path.name,
        reverse=True,
    )
    for path in made[keep:]:
        path.unlink()
    return made[keep:]


def _recorded_origin(path: Path) -> str | None:
    try:
        return read_manifest(path).origin
    except InputError:
        return None


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
    flaws: Sequence[str] = find_flaws(copy)
    if not flaws and schema_of_copy(copy) != manifest.schema_name:
        flaws = ["it has another schema"]
    if not flaws and (rows := count_rows(copy)) != manifest.rows:
        tables = sorted({*rows, *manifest.rows})
        wrong = [name for name in tables if rows.get(name) != manifest.rows.get(name)]
        flaws = [f"another number of rows in {listed(wrong)}"]
    if flaws:
        raise InputError(
            f"the database in it is not what was backed up: {'; '.join(flaws[:3])}",
            where=archive,
            remedy=REMEDY,
        )
